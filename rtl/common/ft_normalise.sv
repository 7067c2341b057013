// SPDX-License-Identifier: Apache-2.0
// Shifts a mantissa left until its highest one is at the top: by nibbles first, then by bits, so that
// no count of single zeros is waited for.
module ft_normalise (
    input  logic [23:0] value,
    output logic [23:0] shifted,
    output logic [4:0]  count    // 23 where there is none
);
  logic [23:0] coarse_value;
  logic [2:0] top;  // of the nibble with the highest one
  logic [2:0] coarse;
  logic [1:0] fine;

  always_comb begin
    coarse = 3'd5;
    top    = value[3:1];
    for (int i = 1; i < 6; i++) begin
      if (|value[4*i+:4]) begin
        coarse = 3'(5 - i);
        top    = value[4*i+1+:3];
      end
    end
  end

  assign coarse_value = value << {coarse, 2'b00};

  always_comb begin
    if (top[2]) fine = 2'd0;
    else if (top[1]) fine = 2'd1;
    else if (top[0]) fine = 2'd2;
    else fine = 2'd3;
  end

  assign shifted = coarse_value << fine;
  assign count   = {coarse, fine};
endmodule
