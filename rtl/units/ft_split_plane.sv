// SPDX-License-Identifier: Apache-2.0
// Second half of step 5: the axis of a node and its plane. Records of 16 bytes go to memory, without
// children yet. A node a cycle.
module ft_split_plane #(
    parameter int BLOCK = 64
) (
    input  logic               clk,
    input  logic               rst,
    input  ft_pkg::grid_t      grid,
    input  logic               start,
    input  logic [31:0]        count,  // nodes
    input  logic [31:0]        nodes,  // where the records go
    input  logic               node_valid,
    output logic               node_ready,
    input  logic [31:0]        node_code,  // of the upper leaf
    input  logic [4:0]         node_bit,   // the highest in which the two leaves differ
    output logic               wr_valid,
    input  logic               wr_ready,
    output logic [31:0]        wr_addr,
    output logic [6:0]         wr_bytes,
    output logic [8*BLOCK-1:0] wr_data,
    output logic               done,
    output logic [3:0]         activity
);
  logic advance;

  // The cell that the node's upper half begins with, by its code; and the axis of the node's level.
  logic        valid1, valid2;
  logic [29:0] code1;
  logic [1:0]  axis_1, axis1, axis2;
  logic        of_y, of_z;

  assign of_y   = 1'({2'b00, grid.mask[59:30]} >> node_bit);
  assign of_z   = 1'({2'b00, grid.mask[89:60]} >> node_bit);
  assign axis_1 = of_y ? 2'd1 : of_z ? 2'd2 : 2'd0;

  // Its coordinate on that axis.
  logic [29:0] mask_2, own_2;
  logic [14:0] k_2, k2;
  assign mask_2 = axis1 == 2'd0 ? grid.mask[29:0] :
                  axis1 == 2'd1 ? grid.mask[59:30] : grid.mask[89:60];
  assign own_2  = code1 & mask_2;
  always_comb begin
    k_2 = '0;
    for (int j = 0; j < 15; j++) begin
      for (int i = 0; i < 30; i++) begin
        k_2[j] = k_2[j] | (own_2[i] && grid.rank[4*i+:4] == 4'(j));
      end
    end
  end

  always_ff @(posedge clk) begin
    if (rst) begin
      valid1 <= 1'b0;
      valid2 <= 1'b0;
    end else if (advance) begin
      valid1 <= node_valid;
      valid2 <= valid1;
    end
    if (advance) begin
      code1 <= 30'(node_code) & (30'h3fff_ffff << node_bit);
      axis1 <= axis_1;
      k2    <= k_2;
      axis2 <= axis1;
    end
  end

  logic        plane_valid, plane_busy;
  logic [31:0] plane;
  logic [1:0]  plane_axis;
  ft_plane planes (
      .clk, .rst, .advance, .grid,
      .in_valid(valid2), .in_k(k2), .in_axis(axis2),
      .out_valid(plane_valid), .out_plane(plane), .out_axis(plane_axis), .busy(plane_busy)
  );

  logic put_ready, holds, flush;
  logic [31:0] left;  // records to come
  ft_block_writer #(.BLOCK(BLOCK), .ITEM(16)) writer (
      .clk,
      .start(start || rst), .addr(nodes),
      .put_valid(plane_valid), .put_ready,
      .put_data({30'd0, plane_axis, plane, 64'd0}),
      .flush, .holds,
      .wr_valid, .wr_ready, .wr_addr, .wr_bytes, .wr_data
  );

  assign advance    = !plane_valid || put_ready;
  assign node_ready = advance;
  assign flush      = left == '0;
  assign done       = flush && !holds;

  always_ff @(posedge clk) begin
    if (rst) left <= '0;
    else if (start) left <= count;
    else if (plane_valid && put_ready) left <= left - 1'b1;
  end

  always_comb begin
    if (!advance || (flush && holds && !wr_ready)) activity = ft_pkg::Stalled;  // the bus
    else if (node_valid || valid1 || valid2 || plane_busy || (flush && holds)) activity = ft_pkg::Busy;
    else activity = ft_pkg::Idle;
  end

`ifndef SYNTHESIS
  always_ff @(posedge clk) begin
    if (!rst) begin
      assert (!(flush && plane_valid)) else $error("ft_split_plane: more nodes than were announced");
      assert (!valid2 || k2 != '0) else $error("ft_split_plane: a plane below the first cell");
    end
  end
`endif
endmodule
