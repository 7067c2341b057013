// SPDX-License-Identifier: Apache-2.0
// First in, first out, of any depth. What is written in a cycle can be seen in the next, and room
// made in a cycle can be used in the next: no path leads from one side's handshake to the other's.
module ft_fifo #(
    parameter int WIDTH = 8,
    parameter int DEPTH = 4  // 2 is enough for an element a cycle
) (
    input  logic             clk,
    input  logic             rst,
    input  logic             in_valid,
    output logic             in_ready,
    input  logic [WIDTH-1:0] in_data,
    output logic             out_valid,
    input  logic             out_ready,
    output logic [WIDTH-1:0] out_data,
    output logic [$clog2(DEPTH+1)-1:0] count
);
  localparam int PointerBits = DEPTH > 1 ? $clog2(DEPTH) : 1;
  localparam int CountBits = $clog2(DEPTH + 1);
  localparam logic [PointerBits-1:0] Last = PointerBits'(DEPTH - 1);

  logic [WIDTH-1:0] slots[0:DEPTH-1];
  logic [PointerBits-1:0] head, tail;
  logic push, pop;

  assign in_ready  = count != CountBits'(DEPTH);
  assign out_valid = count != '0;
  assign out_data  = slots[head];
  assign push      = in_valid && in_ready;
  assign pop       = out_valid && out_ready;

  always_ff @(posedge clk) begin
    if (push) slots[tail] <= in_data;
    if (rst) begin
      head  <= '0;
      tail  <= '0;
      count <= '0;
    end else begin
      if (push) tail <= tail == Last ? '0 : tail + 1'b1;
      if (pop) head <= head == Last ? '0 : head + 1'b1;
      if (push && !pop) count <= count + 1'b1;
      if (!push && pop) count <= count - 1'b1;
    end
  end

`ifndef SYNTHESIS
  always_ff @(posedge clk) begin
    if (!rst) begin
      assert ((head == tail) == (count == '0 || count == CountBits'(DEPTH)))
      else $error("ft_fifo: the pointers and the count disagree");
    end
  end
`endif
endmodule
