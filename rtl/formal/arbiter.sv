// SPDX-License-Identifier: Apache-2.0
// ft_arbiter grants to one of those who ask, and whoever goes on asking has its turn before any
// other has two. For two to five clients.
// engine: pdr
// sources: common/ft_arbiter.sv
// fault: common/ft_arbiter.sv: |behind ? behind_first : any_first => any_first
// fault: common/ft_arbiter.sv: ~(grant | (grant - 1'b1)) => ~(grant - 1'b1)
// fault: common/ft_arbiter.sv: behind & (~behind + 1'b1) => behind
module arbiter_turns #(
    parameter int CLIENTS = 4
) (
    input logic               clk,
    input logic               rst,
    input logic [CLIENTS-1:0] request,
    input logic               take,
    input logic [CLIENTS-1:0] choice  // in the cycle of the reset: whom to watch
);
  logic [CLIENTS-1:0] grant, who, passed;  // passed: who had a turn while `who` was asking

  ft_arbiter #(.CLIENTS(CLIENTS)) dut (.clk, .rst, .request, .take, .grant);

  always_ff @(posedge clk) begin
    if (rst) begin
      who    <= choice & (~choice + 1'b1);
      passed <= '0;
    end else begin
      assert ((grant & ~request) == '0);
      assert ((grant & (grant - 1'b1)) == '0);
      assert ((grant != '0) == (request != '0));
      if (take && (request & who) != '0) assert ((grant & passed) == '0);
      if ((request & who) == '0 || (take && (grant & who) != '0)) passed <= '0;
      else if (take) passed <= passed | grant;
    end
  end
endmodule

module proof (
    input logic        clk,
    input logic [19:0] request,
    input logic [19:0] choice,
    input logic [ 3:0] take
);
  logic rst = 1'b1;
  always_ff @(posedge clk) rst <= 1'b0;

  for (genvar c = 2; c <= 5; c++) begin : clients
    arbiter_turns #(.CLIENTS(c)) check (
        .clk, .rst, .request(request[5*(c-2)+:c]), .choice(choice[5*(c-2)+:c]), .take(take[c-2])
    );
  end
endmodule
