// SPDX-License-Identifier: Apache-2.0
// A skid buffer: cuts the path of `ready` between two stages and passes an element a cycle.
module ft_skid #(
    parameter int WIDTH = 8
) (
    input  logic             clk,
    input  logic             rst,
    input  logic             in_valid,
    output logic             in_ready,
    input  logic [WIDTH-1:0] in_data,
    output logic             out_valid,
    input  logic             out_ready,
    output logic [WIDTH-1:0] out_data
);
  logic full;  // what came while the taker was not ready
  logic [WIDTH-1:0] spare;

  assign in_ready = !full;

  always_ff @(posedge clk) begin
    if (rst) begin
      full      <= 1'b0;
      out_valid <= 1'b0;
    end else if (!out_valid || out_ready) begin
      out_valid <= full || in_valid;
      full      <= 1'b0;
    end else if (in_valid && in_ready) begin
      full <= 1'b1;
    end
    if (!out_valid || out_ready) out_data <= full ? spare : in_data;
    if (in_valid && in_ready) spare <= in_data;
  end
endmodule
