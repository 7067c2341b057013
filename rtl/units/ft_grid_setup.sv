// SPDX-License-Identifier: Apache-2.0
// The registers of the grid from the scene's bounds: extents, scales, and which axis each level
// halves. Once a build, so one of everything: a subtractor that shifts by 4 or 1 places a cycle, a
// divider of a bit a cycle, a level a cycle.
//
// An axis is live where its extent e is above 2^-20 of the longest one and 2^15 / e is finite. The
// latter is e > 2^-113. Where that holds, e and 2^15 / e are normal, so that subnormals matter to
// the subtraction alone; and 2^-20 of the longest one, where it is above 2^-113, is exact.
module ft_grid_setup (
    input  logic           clk,
    input  logic           rst,
    input  logic           start,
    input  logic [95:0]    lo,           // binary32, finite, at most hi; stable as long as the grid is used
    input  logic [95:0]    hi,
    input  logic           longest,      // 0: axes in turn; 1: always the one with the longest side
    input  logic [4:0]     depth_asked,
    output ft_pkg::grid_t  grid,
    output logic           done
);
  localparam logic [7:0] LeastExponent = 8'd14;     // of 2^-113
  localparam logic [7:0] RatioExponent = 8'd20;     // dead: at most 2^-20 of the longest extent
  localparam logic [4:0] QuotientBits = 5'd25;      // the one before the point, 23 behind it, one to round by
  localparam logic [4:0] MaxDepth = 5'(ft_pkg::MaxDepth);

  typedef enum logic [2:0] {Rest, Load, Align, Normalise, Threshold, Live, Depth, Divide} state_t;
  state_t state;
  logic [1:0] axis;

  logic [95:0] extent, scale;
  assign grid.lo     = lo;
  assign grid.extent = extent;
  assign grid.scale  = scale;

  // --- hi - lo, not negative. Three bits behind the mantissas: guard, round, sticky.
  logic [31:0] lo_axis, hi_axis, larger, smaller;
  logic swap;
  logic [27:0] sum;                   // with a carry
  logic [26:0] addend;
  logic [7:0] sum_exponent, addend_exponent, gap;
  logic add;
  logic aligned, normal, round_up;
  logic [30:0] rounded;

  assign lo_axis  = axis[1] ? lo[95:64] : axis[0] ? lo[63:32] : lo[31:0];
  assign hi_axis  = axis[1] ? hi[95:64] : axis[0] ? hi[63:32] : hi[31:0];
  assign swap     = lo_axis[30:0] > hi_axis[30:0];
  assign larger   = swap ? lo_axis : hi_axis;
  assign smaller  = swap ? hi_axis : lo_axis;
  assign gap      = sum_exponent - addend_exponent;
  // Only the sticky bit is left: that stays, however far it is shifted.
  assign aligned  = gap == '0 || addend[26:1] == '0;
  assign normal   = !sum[27] && (sum[26] || sum_exponent == 8'd1 || sum == '0);
  assign round_up = sum[2] && (sum[3] || sum[1] || sum[0]);
  assign rounded  = {sum[26] ? sum_exponent : 8'd0, &sum_exponent ? 23'd0 : sum[25:3]}
                  + 31'(round_up && !(&sum_exponent));

  always_ff @(posedge clk) begin
    case (state)
      Load: begin
        sum             <= {1'b0, larger[30:23] != '0, larger[22:0], 3'd0};
        addend          <= {smaller[30:23] != '0, smaller[22:0], 3'd0};
        sum_exponent    <= larger[30:23] == '0 ? 8'd1 : larger[30:23];
        addend_exponent <= smaller[30:23] == '0 ? 8'd1 : smaller[30:23];
        add             <= larger[31] != smaller[31];
      end
      Align: begin
        if (aligned) begin
          sum <= add ? sum + {1'b0, addend} : sum - {1'b0, addend};
        end else if (gap[7:2] != '0) begin
          addend          <= {4'd0, addend[26:5], |addend[4:0]};
          addend_exponent <= addend_exponent + 8'd4;
        end else begin
          addend          <= {1'b0, addend[26:2], |addend[1:0]};
          addend_exponent <= addend_exponent + 8'd1;
        end
      end
      Normalise: begin
        if (sum[27]) begin
          sum          <= {1'b0, sum[27:2], |sum[1:0]};
          sum_exponent <= sum_exponent + 8'd1;
        end else if (!normal) begin
          if (sum[26:23] == '0 && sum_exponent > 8'd4) begin
            sum          <= sum << 4;
            sum_exponent <= sum_exponent - 8'd4;
          end else begin
            sum          <= sum << 1;
            sum_exponent <= sum_exponent - 8'd1;
          end
        end
      end
      default: ;
    endcase
  end

  // --- Sides of a cell: extents less a power of two. The longest one that may be halved.
  logic [7:0] side_x, side_y, side_z;  // exponents
  logic y_above_x, z_above_x, z_above_y;
  logic [2:0] live, open, choice;      // by axis
  logic take_y, take_z;
  logic [2:0] turn;                    // axes in turn: the first one to look at
  logic [3:0] bits_x, bits_y, bits_z;

  assign y_above_x = {side_y, extent[54:32]} > {side_x, extent[22:0]};
  assign z_above_x = {side_z, extent[86:64]} > {side_x, extent[22:0]};
  assign z_above_y = {side_z, extent[86:64]} > {side_y, extent[54:32]};
  assign open      = state == Threshold ? 3'b111
                   : live & {bits_z != 4'd15, bits_y != 4'd15, bits_x != 4'd15};
  assign take_y    = open[1] && (!open[0] || y_above_x);
  assign take_z    = open[2] && (open[1:0] == '0 || (take_y ? z_above_y : z_above_x));
  always_comb begin
    if (longest || state == Threshold) begin
      choice = {take_z, take_y && !take_z, open[0] && !take_y && !take_z};
    end else begin
      choice = open;
      if (turn[0]) choice = open[0] ? 3'b001 : open[1] ? 3'b010 : open & 3'b100;
      if (turn[1]) choice = open[1] ? 3'b010 : open[2] ? 3'b100 : open & 3'b001;
      if (turn[2]) choice = open[2] ? 3'b100 : open[0] ? 3'b001 : open & 3'b010;
    end
  end

  // --- Which axes are live.
  logic [30:0] axis_extent, longest_extent, threshold;
  logic is_live;
  assign axis_extent    = axis[1] ? extent[94:64] : axis[0] ? extent[62:32] : extent[30:0];
  assign longest_extent = choice[2] ? extent[94:64] : choice[1] ? extent[62:32] : extent[30:0];
  assign is_live        = axis_extent > threshold;

  always_ff @(posedge clk) begin
    if (state == Threshold) begin
      // Of an infinite extent 2^-20 is infinite.
      if (&longest_extent[30:23]) threshold <= '1;
      else if (longest_extent[30:23] < LeastExponent + RatioExponent) threshold <= {LeastExponent, 23'd0};
      else threshold <= {longest_extent[30:23] - RatioExponent, longest_extent[22:0]};
    end
    if (state == Live) live <= {is_live, live[2:1]};
  end

  // --- 2^15 / extent. Of the mantissa m, 1 < m < 2, it is 2 / m, which is no tie and does not round
  // up to 2; of m = 1 it is 1 / m.
  logic [4:0] step;
  logic [24:0] rest;                  // less than twice the divisor
  logic [25:0] less;
  logic [24:0] quotient;
  logic fits, power_of_two;

  assign power_of_two = axis_extent[22:0] == '0;
  assign less         = {1'b0, rest} - {3'b001, axis_extent[22:0]};
  assign fits         = less[25:24] == '0;

  always_ff @(posedge clk) begin
    if (step == '0) rest <= {!power_of_two, power_of_two, 23'd0};
    else rest <= {fits ? less[23:0] : rest[23:0], 1'b0};
    quotient <= {quotient[23:0], fits};
  end

  // --- The levels from the top, one a cycle, then the ranks from the last bit on.
  logic [29:0] mask_x, mask_y, mask_z;
  logic [119:0] rank;
  logic [4:0] depth, level, cap;
  logic ranking;                      // second pass
  logic halve, count_rank;

  assign cap        = (live[0] && live[1]) || (live[2] && (live[0] || live[1])) ? MaxDepth
                    : live != '0 ? 5'(ft_pkg::MaxAxisBits) : 5'd0;
  assign halve      = state == Divide && !ranking && level != depth;
  assign count_rank = state == Divide && ranking && level != MaxDepth;
  assign grid.depth = depth;
  assign grid.bits  = {bits_z, bits_y, bits_x};
  assign grid.mask  = {mask_z, mask_y, mask_x};
  assign grid.rank  = rank;

  always_ff @(posedge clk) begin
    if (rst) begin
      ranking <= 1'b0;
    end else if (state == Depth) begin
      depth   <= depth_asked > cap ? cap : depth_asked;
      level   <= '0;
      ranking <= 1'b0;
      turn    <= 3'b001;
      mask_x  <= '0;
      mask_y  <= '0;
      mask_z  <= '0;
    end else if (halve) begin
      level  <= level + 1'b1;
      turn   <= {choice[1:0], choice[2]};
      mask_x <= {mask_x[28:0], choice[0]};
      mask_y <= {mask_y[28:0], choice[1]};
      mask_z <= {mask_z[28:0], choice[2]};
    end else if (count_rank) begin
      level  <= level + 1'b1;
      mask_x <= {mask_x[0], mask_x[29:1]};
      mask_y <= {mask_y[0], mask_y[29:1]};
      mask_z <= {mask_z[0], mask_z[29:1]};
      rank   <= {mask_x[0] ? bits_x : mask_y[0] ? bits_y : mask_z[0] ? bits_z : 4'd0, rank[119:4]};
    end else if (state == Divide && !ranking) begin
      level   <= '0;
      ranking <= 1'b1;
    end
    if (state == Depth || (state == Divide && !ranking && !halve)) begin
      bits_x <= '0;
      bits_y <= '0;
      bits_z <= '0;
    end else begin
      if (halve ? choice[0] : count_rank && mask_x[0]) bits_x <= bits_x + 1'b1;
      if (halve ? choice[1] : count_rank && mask_y[0]) bits_y <= bits_y + 1'b1;
      if (halve ? choice[2] : count_rank && mask_z[0]) bits_z <= bits_z + 1'b1;
    end
    if (halve && choice[0]) side_x <= side_x - 1'b1;
    if (halve && choice[1]) side_y <= side_y - 1'b1;
    if (halve && choice[2]) side_z <= side_z - 1'b1;
    if (state == Normalise && normal) begin
      case (axis)
        2'd0: side_x <= rounded[30:23];
        2'd1: side_y <= rounded[30:23];
        default: side_z <= rounded[30:23];
      endcase
    end
  end

  // --- From state to state; three of them go over the axes.
  logic next_axis;
  always_comb begin
    case (state)
      Normalise: next_axis = normal;
      Live: next_axis = 1'b1;
      Divide: next_axis = step == QuotientBits + 1'b1;
      default: next_axis = 1'b0;
    endcase
  end

  always_ff @(posedge clk) begin
    if (rst) begin
      state <= Rest;
    end else begin
      case (state)
        Rest: if (start) state <= Load;
        Load: state <= Align;
        Align: if (aligned) state <= Normalise;
        Normalise: if (normal) state <= axis == 2'd2 ? Threshold : Load;
        Threshold: state <= Live;
        Live: if (axis == 2'd2) state <= Depth;
        Depth: state <= Divide;
        default: if (next_axis && axis == 2'd2) state <= Rest;
      endcase
    end
    if (rst || (state == Rest && start)) axis <= '0;
    else if (next_axis) axis <= axis == 2'd2 ? '0 : axis + 1'b1;
    step <= state != Divide || next_axis ? '0 : step + 1'b1;
    if (next_axis) begin
      for (int a = 0; a < 3; a++) begin
        if (axis == 2'(a)) begin
          if (state == Normalise) extent[32*a+:32] <= {1'b0, rounded};
          if (state == Divide) begin
            scale[32*a+:32] <= !live[a] ? 32'd0
                : {1'b0, 8'(9'd268 + 9'(power_of_two) - {1'b0, axis_extent[30:23]}),
                   quotient[23:1] + 23'(quotient[0])};
          end
        end
      end
    end
  end

  assign done = state == Rest;

`ifndef SYNTHESIS
  always_ff @(posedge clk) begin
    if (!rst) begin
      assert (!(start && !done)) else $error("ft_grid_setup: started while at work");
      assert (state != Load || add_is_right) else $error("ft_grid_setup: a lower bound above the upper");
      assert (!(done && ranking) || level == MaxDepth || rst)
      else $error("ft_grid_setup: done before the levels are");
      assert (!(halve && choice == '0)) else $error("ft_grid_setup: no axis to halve");
      assert (!(state == Divide && next_axis && live[axis]) || quotient[24])
      else $error("ft_grid_setup: a quotient below 1");
    end
  end
  logic add_is_right;
  assign add_is_right = lo_axis[31] != hi_axis[31] ? lo_axis[31] || (lo_axis[30:0] | hi_axis[30:0]) == '0
                      : lo_axis[31] ? lo_axis[30:0] >= hi_axis[30:0] : !swap;
`endif
endmodule
