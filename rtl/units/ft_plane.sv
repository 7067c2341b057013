// SPDX-License-Identifier: Apache-2.0
// The plane below a cell: the least binary32 value v whose cell, truncate(RN(RN(v - lo) * scale)), is
// at or above cell k of the axis. Exact, a plane a cycle; docs/accelerator/internal_node.md derives it.
//
// 1. The greatest binary32 value p with RN(p * scale) < k. p is near k * extent * 2^-15, from which
//    five products of neighbouring significands with `scale` decide.
// 2. RN(v - lo) > p holds from the midpoint above p on, and at the midpoint itself where p's last bit
//    is 1. Hence v is lo + midpoint, or just above it, rounded up: an adder for binary32.
module ft_plane (
    input  logic           clk,
    input  logic           rst,
    input  logic           advance,  // all stages move on
    input  ft_pkg::grid_t  grid,
    input  logic           in_valid,
    input  logic [14:0]    in_k,     // 1 to 2^bits - 1
    input  logic [1:0]     in_axis,
    output logic           out_valid,
    output logic [31:0]    out_plane,
    output logic [1:0]     out_axis,
    output logic           busy      // any stage holds something
);
  localparam int Stages = 17;

  function automatic logic [31:0] word_of(input logic [95:0] words, input logic [1:0] axis);
    word_of = axis == 2'd0 ? words[31:0] : axis == 2'd1 ? words[63:32] : words[95:64];
  endfunction

  logic [Stages:1] valid;
  logic [2*Stages-1:0] axes;  // stage s in bits [2 * (s - 1) +: 2]

  assign out_valid = valid[Stages];
  assign out_axis  = axes[2*Stages-1-:2];
  assign busy      = |valid;

  always_ff @(posedge clk) begin
    if (rst) valid <= '0;
    else if (advance) valid <= {valid[Stages-1:1], in_valid};
    if (advance) axes <= {axes[2*Stages-3:0], in_axis};
  end

  // 1, 2: k with its leading one in front, and the exponent so far (biased like binary32's, of the
  // last bit of a significand of 24 bits, plus 150).
  logic [7:0]  extent_exponent_1;
  logic [3:0]  bits_1;
  logic [14:0] k_eight, k_four, k1, k_two, k_one, k2;
  logic [9:0]  e1, e2;
  logic        left_8, left_4, left_2, left_1;  // moved so many places
  logic [22:0] extent2;

  assign extent_exponent_1 = 8'(word_of(grid.extent, in_axis) >> 23);
  assign bits_1   = in_axis == 2'd0 ? grid.bits[3:0] : in_axis == 2'd1 ? grid.bits[7:4] : grid.bits[11:8];
  assign left_8 = in_k[14:7] == '0;
  assign k_eight   = left_8 ? {in_k[6:0], 8'd0} : in_k;
  assign left_4 = k_eight[14:11] == '0;
  assign k_four    = left_4 ? {k_eight[10:0], 4'd0} : k_eight;
  assign left_2 = k1[14:13] == '0;
  assign k_two     = left_2 ? {k1[12:0], 2'd0} : k1;
  assign left_1 = !k_two[14];
  assign k_one     = left_1 ? {k_two[13:0], 1'b0} : k_two;

  logic [1:0] left1;
  always_ff @(posedge clk) begin
    if (advance) begin
      k1      <= k_four;
      left1   <= {left_8, left_4};
      e1      <= 10'(extent_exponent_1) + 10'd13 - 10'(bits_1);
      k2      <= k_one;
      e2      <= e1 - 10'({left1, left_2, left_1});
      extent2 <= 23'(word_of(grid.extent, axes[1:0]));
    end
  end

  // 3: the guess k * extent, exactly. 4: its first 25 bits, one more than a significand has.
  logic [38:13] product3;
  logic        power3, whole3;  // significands of k and of the extent that are 1
  logic [9:0]  e3, e4;
  logic [24:0] guess4;
  logic [22:0] scale4;
  logic [2:0]  half4;           // which of 2^22, 2^23, 2^24 is half a unit in the last place below k

  always_ff @(posedge clk) begin
    if (advance) begin
      product3 <= 26'((39'(k2) * 39'({1'b1, extent2})) >> 13);
      power3   <= k2[13:0] == '0;
      whole3   <= extent2 == '0;
      e3       <= e2;
      guess4   <= product3[38] ? product3[38:14] : product3[37:13];
      e4       <= e3 + 10'(product3[38]);
      half4    <= product3[38] || whole3 ? {1'b0, !power3, power3} : {!power3, power3, 1'b0};
      scale4   <= 23'(word_of(grid.scale, axes[5:4]));
    end
  end

  // 5, 6: guess * scale less k rounded down to where rounding takes it to k. It is small, so 28 bits
  // tell it, and in these k itself is zero.
  logic [27:0] low5;
  logic [10:0] high5;
  logic [23:0] scale5, scale6;
  logic [25:0] triple6;
  logic [2:0]  half5;
  logic [27:0] off6;

  always_ff @(posedge clk) begin
    if (advance) begin
      low5    <= 28'(guess4[16:0]) * 28'({1'b1, scale4});
      high5   <= 11'(guess4[24:17]) * scale4[10:0];
      scale5  <= {1'b1, scale4};
      half5   <= half4;
      off6    <= {low5[27:17] + high5 + {3'd0, half5, 5'd0}, low5[16:0]};
      scale6  <= scale5;
      triple6 <= {1'b0, scale5, 1'b0} + 26'(scale5);
    end
  end

  // 7: which of the guess less 3 to the guess plus 1 are too small. 8: the greatest that is.
  logic [4:0]  small7;
  logic [24:0] below8;
  logic [2:0]  step_8;
  logic [74:0] guesses;  // 5 to 7
  logic [39:0] exponents;  // 5 to 8

  always_comb begin
    case (small7)
      5'b00000: step_8 = 3'd4;  // less 4
      5'b00001: step_8 = 3'd5;
      5'b00011: step_8 = 3'd6;
      5'b00111: step_8 = 3'd7;
      5'b01111: step_8 = 3'd0;
      default:  step_8 = 3'd1;
    endcase
  end

  always_ff @(posedge clk) begin
    if (advance) begin
      guesses   <= {guesses[49:0], guess4};
      exponents <= {exponents[29:0], e4};
      small7    <= {$signed(~off6) >= $signed(28'(scale6)), off6[27],
                    $signed(off6) < $signed(28'(scale6)), $signed(off6) < $signed(28'({scale6, 1'b0})),
                    $signed(off6) < $signed(28'(triple6))};
      below8    <= guesses[74:50] + {{22{step_8[2]}}, step_8};
    end
  end

  // 9: p's significand; the midpoint has a 1 behind it. 10: which of p and lo has the larger
  // exponent, where both have 25 bits.
  logic [31:0] lo_9;
  logic [7:0]  lo_exponent_9;
  logic [24:0] lo9;
  logic [7:0]  lo_exponent9;
  logic        minus9;
  logic [23:0] below9;
  logic [7:0]  e9;
  logic [9:0]  apart9;
  logic [9:0]  gap_10;
  logic [24:0] big10, little10;
  logic [7:0]  e10;
  logic [4:0]  shift10;
  logic        lo_big10, minus10, above10;

  assign lo_9          = word_of(grid.lo, axes[15:14]);
  assign lo_exponent_9 = lo_9[30:23] == '0 ? 8'd1 : lo_9[30:23];
  assign gap_10        = apart9[9] ? -apart9 : apart9;

  always_ff @(posedge clk) begin
    if (advance) begin
      minus9       <= lo_9[31];
      lo9          <= {lo_9[30:23] != '0, lo_9[22:0], 1'b0};
      lo_exponent9 <= lo_exponent_9;
      below9       <= below8[24] ? below8[24:1] : below8[23:0];
      e9           <= exponents[37:30] + 8'(below8[24]);
      apart9       <= 10'(lo_exponent_9) - exponents[39:30] - 10'(below8[24]);
      big10        <= apart9[9] ? {below9, 1'b1} : lo9;
      little10     <= apart9[9] ? lo9 : {below9, 1'b1};
      e10          <= apart9[9] ? e9 : lo_exponent9;
      shift10      <= gap_10 > 10'd31 ? 5'd31 : gap_10[4:0];
      lo_big10     <= !apart9[9];
      minus10      <= minus9;
      above10      <= !below9[0];
    end
  end

  // 11: the smaller one moved to the larger one's exponent, with one bit more; `more`: the exact sum
  // is above what the bits say, by less than the last one. A negative lo is inverted, which is one
  // less than its negative; where bits of it are dropped that is already rounded down.
  logic [25:0] moved_11, ones_11;
  logic [27:0] big11, little11;
  logic        dropped_11, more11, carry11;
  logic [7:0]  e11;

  assign moved_11   = {little10, 1'b0} >> shift10;
  assign ones_11    = ~(26'h3ff_ffff << shift10);
  assign dropped_11 = ({little10, 1'b0} & ones_11) != '0;

  always_ff @(posedge clk) begin
    if (advance) begin
      big11    <= {2'b00, big10, 1'b0} ^ {28{minus10 && lo_big10}};
      little11 <= {2'b00, moved_11} ^ {28{minus10 && !lo_big10}};
      carry11  <= minus10 && (lo_big10 || !dropped_11);
      more11   <= dropped_11 || above10;
      e11      <= e10;
    end
  end

  // 12: the sum. 13: its size, rounded towards zero.
  logic [27:0] sum12;
  logic        more12, more13, minus13;
  logic [7:0]  e12, e13;
  logic [26:0] size13;

  always_ff @(posedge clk) begin
    if (advance) begin
      sum12   <= big11 + little11 + 28'(carry11);
      more12  <= more11;
      e12     <= e11;
      size13  <= (sum12[26:0] ^ {27{sum12[27]}}) + 27'(sum12[27] && !more12);
      minus13 <= sum12[27];
      more13  <= more12;
      e13     <= e12;
    end
  end

  // 14: zeros in front. 15: how far to go: not below the least exponent. 16: there. What moves in is
  // zero, or, where a negative sum is just above what its bits say, ones.
  logic [4:0]  zeros_14, zeros14, shift15;
  logic        any_14, more14, more15, minus14, minus15, minus16, up16;
  logic [7:0]  e14, e15, e16;
  logic [26:0] size14, size15;
  logic [26:0] moved_16;
  logic [23:0] size16;

  always_comb begin
    zeros_14 = 5'd27;
    any_14   = 1'b0;
    for (int i = 26; i >= 0; i--) begin
      if (size13[i] && !any_14) begin
        zeros_14 = 5'(26 - i);
        any_14   = 1'b1;
      end
    end
  end
  assign moved_16 = 27'(({size15, {27{minus15 && more15}}} << shift15) >> 27);

  always_ff @(posedge clk) begin
    if (advance) begin
      zeros14 <= zeros_14;
      size14  <= size13;
      minus14 <= minus13;
      more14  <= more13;
      e14     <= e13;
      shift15 <= e14 < 8'(zeros14) ? e14[4:0] : zeros14;
      e15     <= e14 < 8'(zeros14) ? '0 : e14 - 8'(zeros14);
      size15  <= size14;
      minus15 <= minus14;
      more15  <= more14;
      size16  <= moved_16[26:3];
      up16    <= !minus15 && (moved_16[2:0] != '0 || more15);
      minus16 <= minus15;
      e16     <= e15;
    end
  end

  // 17: rounded up. The leading one adds itself to the exponent, which has one less.
  always_ff @(posedge clk) begin
    if (advance) begin
      out_plane <= {minus16 && size16 != '0, {e16, 23'd0} + 31'(size16) + 31'(up16)};
    end
  end
endmodule
