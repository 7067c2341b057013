// SPDX-License-Identifier: Apache-2.0
// Whether an aligned block of 64 bytes lies outside a window of memory.
module ft_window (
    input  logic [31:6] block,
    input  logic [31:6] first,   // of the window
    input  logic [31:6] behind,  // the first block behind it; 0: the window reaches to the end
    output logic        outside
);
  assign outside = block < first || (behind != '0 && block >= behind);
endmodule
