// SPDX-License-Identifier: Apache-2.0
// What AXI4 asks of a master, as far as one can see it at the wires. Simulation only.
module ft_axi_rules #(
    parameter int BUS_BYTES = 16,
    parameter int ID_BITS = 4
) (
    input logic                   clk,
    input logic                   rst,
    input logic                   aw_valid,
    input logic                   aw_ready,
    input logic [31:0]            aw_addr,
    input logic [7:0]             aw_len,
    input logic [ID_BITS-1:0]     aw_id,
    input logic                   w_valid,
    input logic                   w_ready,
    input logic [8*BUS_BYTES-1:0] w_data,
    input logic [BUS_BYTES-1:0]   w_strb,
    input logic                   w_last,
    input logic                   ar_valid,
    input logic                   ar_ready,
    input logic [31:0]            ar_addr,
    input logic [7:0]             ar_len,
    input logic [ID_BITS-1:0]     ar_id
);
`ifndef SYNTHESIS
  localparam int BusShift = $clog2(BUS_BYTES);

  logic aw_waits, w_waits, ar_waits;  // valid and not taken in the cycle before
  logic [40+ID_BITS-1:0] aw_was, ar_was;
  logic [9*BUS_BYTES:0] w_was;
  logic [12:0] aw_end, ar_end;  // of the burst in its 4 KB

  assign aw_end = 13'({aw_addr[11:BusShift], {BusShift{1'b0}}}) + ((13'(aw_len) + 13'd1) << BusShift);
  assign ar_end = 13'({ar_addr[11:BusShift], {BusShift{1'b0}}}) + ((13'(ar_len) + 13'd1) << BusShift);

  always_ff @(posedge clk) begin
    aw_waits <= aw_valid && !aw_ready && !rst;
    w_waits  <= w_valid && !w_ready && !rst;
    ar_waits <= ar_valid && !ar_ready && !rst;
    aw_was   <= {aw_addr, aw_len, aw_id};
    ar_was   <= {ar_addr, ar_len, ar_id};
    w_was    <= {w_data, w_strb, w_last};
    if (!rst) begin
      assert (!aw_waits || aw_valid) else $error("ft_axi_rules: AWVALID withdrawn");
      assert (!w_waits || w_valid) else $error("ft_axi_rules: WVALID withdrawn");
      assert (!ar_waits || ar_valid) else $error("ft_axi_rules: ARVALID withdrawn");
      assert (!aw_waits || aw_was == {aw_addr, aw_len, aw_id}) else $error("ft_axi_rules: AW changed");
      assert (!w_waits || w_was == {w_data, w_strb, w_last}) else $error("ft_axi_rules: W changed");
      assert (!ar_waits || ar_was == {ar_addr, ar_len, ar_id}) else $error("ft_axi_rules: AR changed");
      assert (!aw_valid || aw_end <= 13'd4096) else $error("ft_axi_rules: AW leaves its 4 KB");
      assert (!ar_valid || ar_end <= 13'd4096) else $error("ft_axi_rules: AR leaves its 4 KB");
    end
  end
`endif
endmodule
