// SPDX-License-Identifier: Apache-2.0
// Scene bound calculation unit (SBCU): the least, or the greatest, of a group of coordinates of one
// axis in log2(INPUTS) stages of compare and select, then against the bound so far. A group a cycle.
module ft_scene_bound #(
    parameter bit UPPER  = 0,  // the greatest
    parameter int INPUTS = 8   // a power of two
) (
    input  logic                 clk,
    input  logic                 rst,
    input  logic                 start,      // forget the old bound
    input  logic                 in_valid,
    output logic                 in_ready,
    input  logic [1:0]           in_axis,
    input  logic [32*INPUTS-1:0] in_values,  // binary32, finite
    output logic [95:0]          bound,      // of each axis; plus zero for minus zero, 0 where nothing came
    output logic                 done,
    output logic [3:0]           activity
);
  localparam int Stages = $clog2(INPUTS);

  // A tree of registers: node i is the better one of nodes 2i + 1 and 2i + 2; what comes in follows
  // behind the last of them. `below` begins at node 1.
  logic [32*(INPUTS-1)-1:0] node;
  logic [32*(2*INPUTS-2)-1:0] below;
  logic [Stages-1:0] full;         // by stage, that of the leaves first
  logic [2*Stages-1:0] axes;
  logic [2:0] any;                 // the axis has a bound

  assign below = (32*(2*INPUTS-2))'({in_values, node} >> 32);

  for (genvar i = 0; i < INPUTS - 1; i++) begin : g_node
    logic [31:0] a, b;
    logic larger, second;
    assign a = below[64*i+:32];
    assign b = below[64*i+32+:32];
    // Sign and magnitude; which one of two equal ones, or of two zeros, does not matter.
    assign larger = a[31] != b[31] ? a[31] : a[31] ^ (b[30:0] > a[30:0]);
    assign second = larger == UPPER;
    always_ff @(posedge clk) node[32*i+:32] <= second ? b : a;
  end

  logic [31:0] value, so_far;
  logic [1:0] axis;
  logic larger, better;

  assign value  = node[31:0];
  assign axis   = axes[2*(Stages-1)+:2];
  assign so_far = axis[1] ? bound[95:64] : axis[0] ? bound[63:32] : bound[31:0];
  assign larger = so_far[31] != value[31] ? so_far[31] : so_far[31] ^ (value[30:0] > so_far[30:0]);
  assign better = (larger == UPPER) || (axis[1] ? !any[2] : axis[0] ? !any[1] : !any[0]);

  always_ff @(posedge clk) begin
    for (int s = 1; s < Stages; s++) axes[2*s+:2] <= axes[2*(s-1)+:2];
    axes[1:0] <= in_axis;
    if (rst) full <= '0;
    else full <= Stages'({full, in_valid});
    if (rst || start) begin
      bound <= '0;
      any   <= '0;
    end else if (full[Stages-1]) begin
      for (int a = 0; a < 3; a++) begin
        if (axis == 2'(a)) begin
          any[a] <= 1'b1;
          if (better) bound[32*a+:32] <= {value[31] && value[30:0] != '0, value[30:0]};
        end
      end
    end
  end

  assign in_ready = 1'b1;
  assign done     = full == '0;
  assign activity = in_valid || !done ? ft_pkg::Busy : ft_pkg::Idle;

`ifndef SYNTHESIS
  always_ff @(posedge clk) begin
    if (!rst) begin
      assert (!(start && !done)) else $error("ft_scene_bound: started with groups on the way");
      assert (!in_valid || in_axis != 2'd3) else $error("ft_scene_bound: no such axis");
      for (int i = 0; i < INPUTS; i++) begin
        assert (!in_valid || in_values[32*i+23+:8] != 8'hff)
        else $error("ft_scene_bound: a coordinate is not finite");
      end
    end
  end
`endif
endmodule
