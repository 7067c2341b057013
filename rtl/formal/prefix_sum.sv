// SPDX-License-Identifier: Apache-2.0
// ft_prefix_sum_sweep: up-sweep and down-sweep give the sums that adding one value after another
// gives, and the total. Sections of 8 and 32, values of all bits and of one bit.
// engine: sat
// sources: units/ft_prefix_sum_sweep.sv
// fault: units/ft_prefix_sum_sweep.sv: assign out[WIDTH*i+:WIDTH] = in[WIDTH*(i+Stride)+:WIDTH]; => assign out[WIDTH*i+:WIDTH] = in[WIDTH*i+:WIDTH];
// fault: units/ft_prefix_sum_sweep.sv: i >= 2 * Stride)) begin => i >= 4 * Stride)) begin
// fault: units/ft_prefix_sum_sweep.sv: if (level == Depth - 1) => if (level == Depth)
module same_sums #(
    parameter int WIDTH = 4,
    parameter int SECTION = 8,
    parameter int VALUE_BITS = WIDTH
) (
    input logic [WIDTH*SECTION-1:0] values
);
  logic [WIDTH*SECTION-1:0] clipped, sums, serial;
  logic [WIDTH-1:0] total, running;

  ft_prefix_sum_sweep #(.WIDTH(WIDTH), .SECTION(SECTION), .VALUE_BITS(VALUE_BITS)) dut (
      .in_values(clipped), .in_total('0), .out_values(sums), .out_total(total)
  );
  always_comb begin
    running = '0;
    for (int i = 0; i < SECTION; i++) begin
      clipped[WIDTH*i+:WIDTH] = WIDTH'(values[WIDTH*i+:VALUE_BITS]);
      serial[WIDTH*i+:WIDTH]  = running;
      running = running + clipped[WIDTH*i+:WIDTH];
    end
    assert (sums == serial);
    assert (total == running);
  end
endmodule

module proof (
    input logic [ 31:0] values8,
    input logic [ 63:0] values32,
    input logic [191:0] flags32
);
  same_sums #(.WIDTH(4), .SECTION(8)) narrow8 (.values(values8));
  same_sums #(.WIDTH(2), .SECTION(32)) narrow32 (.values(values32));
  same_sums #(.WIDTH(6), .SECTION(32), .VALUE_BITS(1)) flags (.values(flags32));
endmodule
