// SPDX-License-Identifier: Apache-2.0
// ft_skid loses nothing, repeats nothing and keeps the order; what it offers stays until it is taken;
// whoever waits for it is served while the taker takes.
// engine: pdr
// sources: common/ft_skid.sv
// fault: common/ft_skid.sv: full ? spare : in_data => in_data
// fault: common/ft_skid.sv: full <= 1'b1 => full <= 1'b0
// fault: common/ft_skid.sv: if (!out_valid || out_ready) out_data => if (out_valid) out_data
module proof (
    input logic       clk,
    input logic       in_valid,
    input logic [1:0] in_data,
    input logic       out_ready,
    input logic       mark
);
  logic rst = 1'b1;
  always_ff @(posedge clk) rst <= 1'b0;

  logic in_ready, out_valid, push, pop, followed, waited;
  logic [1:0] out_data, data, offered, ahead, inside;

  ft_skid #(.WIDTH(2)) dut (
      .clk, .rst, .in_valid, .in_ready, .in_data, .out_valid, .out_ready, .out_data
  );
  assign push = in_valid && in_ready;
  assign pop  = out_valid && out_ready;

  always_ff @(posedge clk) begin
    offered <= out_data;
    waited  <= !rst && out_valid && !out_ready;
    if (rst) begin
      followed <= 1'b0;
      inside   <= '0;
    end else begin
      inside <= inside + 2'(push) - 2'(pop);
      if (!followed) begin
        followed <= mark && push;
        data     <= in_data;
        ahead    <= inside - 2'(pop);
      end else if (pop) begin
        followed <= ahead != '0;
        ahead    <= ahead - 1'b1;
      end
      assert (inside <= 2);
      assert (out_valid == (inside != '0));
      assert (in_ready == (inside != 2));
      if (followed) assert (ahead < inside);
      if (followed && ahead == '0) assert (out_data == data);
      if (waited) assert (out_valid && out_data == offered);
    end
  end
endmodule
