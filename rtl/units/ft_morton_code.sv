// SPDX-License-Identifier: Apache-2.0
// Morton code generation unit: a triangle's box, its six bounds through one quantiser, then every
// cell of the box, one a cycle, x fastest. No new triangle is looked at meanwhile.
//
// Cells are held as what they contribute to a code: each bound is spread to the bits of its axis
// once. Since no two axes share a bit, one word holds three coordinates, and a coordinate is
// stepped in place by a carry that passes over the bits of the others.
module ft_morton_code #(
    parameter int INPUT_QUEUE = 2,
    parameter int OUTPUT_QUEUE = 16,  // even
    parameter int PAIRS_PER_CYCLE = 2
) (
    input  logic           clk,
    input  logic           rst,
    input  ft_pkg::grid_t  grid,
    input  logic           tri_valid,
    output logic           tri_ready,
    input  logic [31:0]    tri_id,
    input  logic [287:0]   tri_coords,  // corner c, axis a at [32 * (3 * c + a) +: 32]
    output logic [1:0]     pair_count,  // to be seen: two, one or none
    output logic [64:0]    pair0,       // code, id from bit 32, last of its triangle in bit 64
    output logic [64:0]    pair1,
    input  logic [1:0]     pair_take,   // how many are taken; not more than pair_count
    output logic           done,
    output logic [3:0]     activity     // stalled on: pair_writer
);
  localparam int CodeBits = ft_pkg::MaxDepth;

  typedef enum logic [1:0] {
    Ready,
    Quantise,
    Iterate
  } state_t;
  state_t state;

  logic job_valid, pop, emit, last;
  logic [319:0] job;
  logic [$clog2(INPUT_QUEUE+1)-1:0] jobs;
  ft_fifo #(
      .WIDTH(320),
      .DEPTH(INPUT_QUEUE)
  ) triangles (
      .clk      (clk),
      .rst      (rst),
      .in_valid (tri_valid),
      .in_ready (tri_ready),
      .in_data  ({tri_id, tri_coords}),
      .out_valid(job_valid),
      .out_ready(pop),
      .out_data (job),
      .count    (jobs)
  );
  // The box of the next triangle is made while the last cell goes out.
  assign pop = job_valid && (state == Ready || (emit && last));

  // Three units of three inputs: least and greatest of each axis. Floats by sign and magnitude;
  // which zero is less, or which of equal values, makes no difference.
  logic [95:0] least, greatest;
  for (genvar a = 0; a < 3; a++) begin : g_axis
    logic [31:0] v0, v1, v2;
    logic less01, less02, less12;
    assign v0 = job[32*a+:32];
    assign v1 = job[32*(a+3)+:32];
    assign v2 = job[32*(a+6)+:32];
    assign less01 = v0[31] != v1[31] ? v0[31] : v0[31] ^ (v0[30:0] < v1[30:0]);
    assign less02 = v0[31] != v2[31] ? v0[31] : v0[31] ^ (v0[30:0] < v2[30:0]);
    assign less12 = v1[31] != v2[31] ? v1[31] : v1[31] ^ (v1[30:0] < v2[30:0]);
    assign least[32*a+:32] = less01 ? (less02 ? v0 : v2) : (less12 ? v1 : v2);
    assign greatest[32*a+:32] = less01 ? (less12 ? v2 : v1) : (less02 ? v2 : v0);
  end

  // Lower x, y, z, then upper, one a cycle into the quantiser.
  logic [95:0] box_lo, box_hi;
  logic [31:0] id;
  logic feeding, feed_upper, come_upper;  // which bound goes into the quantiser, and comes out
  logic [1:0] feed_axis, come_axis;
  logic [255:0] feed_bounds;
  logic [127:0] feed_lo, feed_scale;
  logic [15:0] feed_bits;
  assign feed_bounds = {32'd0, box_hi, 32'd0, box_lo};
  assign feed_lo     = {32'd0, grid.lo};
  assign feed_scale  = {32'd0, grid.scale};
  assign feed_bits   = {4'd0, grid.bits};

  logic cell_valid, cell_below, cell_above;
  logic [14:0] cell_place;
  ft_quantiser quantiser (
      .clk      (clk),
      .rst      (rst),
      .in_valid (feeding),
      .in_value (feed_bounds[32*{feed_upper, feed_axis}+:32]),
      .in_lo    (feed_lo[32*feed_axis+:32]),
      .in_scale (feed_scale[32*feed_axis+:32]),
      .in_bits  (feed_bits[4*feed_axis+:4]),
      .out_valid(cell_valid),
      .out_below(cell_below),
      .out_above(cell_above),
      .out_place(cell_place)
  );

  // A bit of a code takes its place of the coordinate, where it is of that axis. The bits of an axis
  // are as many as its cells have: all ones are the last cell.
  logic [3*CodeBits-1:0] mask;
  logic [4*CodeBits-1:0] rank;
  logic [CodeBits-1:0] spread;
  logic [15:0] places;
  assign mask   = grid.mask;
  assign rank   = grid.rank;
  assign places = {1'b0, cell_place};
  for (genvar i = 0; i < CodeBits; i++) begin : g_bit
    logic [3:0] axes;
    assign axes      = {1'b0, mask[2*CodeBits+i], mask[CodeBits+i], mask[i]};
    assign spread[i] = (places[rank[4*i+:4]] || cell_above) && !cell_below && axes[come_axis];
  end

  // The cell's code, with the box's corners: each axis' part counts by itself.
  logic [CodeBits-1:0] code, lower, upper, next;
  logic [CodeBits-1:0] x_mask, y_mask, z_mask, x_next, y_next, z_next, x_part, y_part, z_part;
  logic x_end, y_end, z_end;
  assign x_mask = mask[0+:CodeBits];
  assign y_mask = mask[CodeBits+:CodeBits];
  assign z_mask = mask[2*CodeBits+:CodeBits];
  assign x_next = (code | ~x_mask) + 1'b1;
  assign y_next = (code | ~y_mask) + 1'b1;
  assign z_next = (code | ~z_mask) + 1'b1;
  assign x_end  = ((code ^ upper) & x_mask) == '0;
  assign y_end  = ((code ^ upper) & y_mask) == '0;
  assign z_end  = ((code ^ upper) & z_mask) == '0;
  assign last   = x_end && y_end && z_end;
  assign x_part = x_end ? lower : x_next;
  assign y_part = !x_end ? code : y_end ? lower : y_next;
  assign z_part = x_end && y_end ? z_next : code;
  assign next   = (x_part & x_mask) | (y_part & y_mask) | (z_part & z_mask);

  logic room;
  logic [CodeBits+32:0] first, second;
  ft_fifo_two #(
      .WIDTH(CodeBits + 33),
      .DEPTH(OUTPUT_QUEUE)
  ) pairs (
      .clk       (clk),
      .rst       (rst),
      .in_valid  (emit),
      .in_ready  (room),
      .in_data   ({last, id, code}),
      .out_count (pair_count),
      .out_first (first),
      .out_second(second),
      .out_take  (pair_take)
  );
  assign pair0 = {first[CodeBits+:33], 32'(first[CodeBits-1:0])};
  assign pair1 = {second[CodeBits+:33], 32'(second[CodeBits-1:0])};
  assign emit  = state == Iterate && room;

  always_ff @(posedge clk) begin
    if (pop) begin
      box_lo <= least;
      box_hi <= greatest;
      id     <= job[288+:32];
      code   <= '0;
      lower  <= '0;
      upper  <= '0;
    end else if (emit) begin
      code <= next;
    end else if (cell_valid) begin
      if (come_upper) begin
        upper <= upper | spread;
      end else begin
        code  <= code | spread;
        lower <= lower | spread;
      end
    end

    if (feeding) begin
      feed_axis  <= feed_axis[1] ? 2'd0 : feed_axis + 1'b1;
      feed_upper <= feed_upper ^ feed_axis[1];
      if (feed_upper && feed_axis[1]) feeding <= 1'b0;
    end
    if (cell_valid) begin
      come_axis  <= come_axis[1] ? 2'd0 : come_axis + 1'b1;
      come_upper <= come_upper ^ come_axis[1];
      if (come_upper && come_axis[1]) state <= Iterate;
    end
    if (pop) begin
      feeding <= 1'b1;
      state   <= Quantise;
    end else if (emit && last) begin
      state <= Ready;
    end
    if (rst) begin
      state      <= Ready;
      feeding    <= 1'b0;
      feed_axis  <= 2'd0;
      feed_upper <= 1'b0;
      come_axis  <= 2'd0;
      come_upper <= 1'b0;
    end
  end

  assign done = state == Ready && jobs == '0 && pair_count == 2'd0;
  assign activity = state == Ready && !job_valid ? ft_pkg::Idle :
                    state == Iterate && !room ? ft_pkg::Stalled : ft_pkg::Busy;

`ifndef SYNTHESIS
  always_ff @(posedge clk) begin
    if (!rst) begin
      assert (pair_take <= 2'(PAIRS_PER_CYCLE)) else $error("ft_morton_code: too many pairs taken");
      assert (!cell_valid || state == Quantise) else $error("ft_morton_code: a bound out of turn");
      assert (!emit || ((code | upper) & ~(x_mask | y_mask | z_mask)) == '0)
      else $error("ft_morton_code: a code outside the grid's bits");
    end
  end
`endif
endmodule
