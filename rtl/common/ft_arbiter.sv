// SPDX-License-Identifier: Apache-2.0
// Round robin: of those that ask, the first one at or behind the place after the last one taken.
module ft_arbiter #(
    parameter int CLIENTS = 4
) (
    input  logic               clk,
    input  logic               rst,
    input  logic [CLIENTS-1:0] request,
    input  logic               take,   // the grant is used in this cycle
    output logic [CLIENTS-1:0] grant   // one of `request`, or none where nobody asks
);
  logic [CLIENTS-1:0] from;  // ones from the place that comes first
  logic [CLIENTS-1:0] behind, behind_first, any_first;

  // The lowest set bit of x is x & -x.
  assign behind       = request & from;
  assign behind_first = behind & (~behind + 1'b1);
  assign any_first    = request & (~request + 1'b1);
  assign grant        = |behind ? behind_first : any_first;

  always_ff @(posedge clk) begin
    if (rst) from <= '1;
    // Ones above the place that was taken; none above the last place, which is all again.
    else if (take && |request) from <= ~(grant | (grant - 1'b1));
  end

`ifndef SYNTHESIS
  always_ff @(posedge clk) begin
    if (!rst) begin
      assert ((grant & ~request) == '0) else $error("ft_arbiter: granted to one who did not ask");
      assert ((grant & (grant - 1'b1)) == '0) else $error("ft_arbiter: granted to two");
    end
  end
`endif
endmodule
