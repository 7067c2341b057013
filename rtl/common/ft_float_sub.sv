// SPDX-License-Identifier: Apache-2.0
// a - b of finite binary32 values, subnormals in full, rounded to nearest even. A difference every
// cycle, ft_pkg::FloatSubLatency (3) cycles later.
//
// It is {sign, 9 bits of exponent biased by 127 + 32, fraction}, always with a one before the point,
// and exponent 0 for zero alone: subnormal differences are normalised and large ones do not
// overflow, so that ft_float_mul needs no stage for either.
module ft_float_sub (
    input  logic        clk,
    input  logic [31:0] a,
    input  logic [31:0] b,
    output logic [32:0] difference
);
  localparam logic [8:0] Bias = 9'd32;

  // 1: the larger magnitude first, and how far the smaller one has to move. Subnormals have the
  // exponent of the smallest normal values.
  logic swap, a_normal, b_normal;
  logic [7:0] a_exponent, b_exponent, a_less_b, b_less_a, distance;
  assign swap       = a[30:0] < b[30:0];
  assign a_normal   = |a[30:23];
  assign b_normal   = |b[30:23];
  assign a_exponent = {a[30:24], a[23] | !a_normal};
  assign b_exponent = {b[30:24], b[23] | !b_normal};
  assign a_less_b   = a_exponent - b_exponent;
  assign b_less_a   = b_exponent - a_exponent;
  assign distance   = swap ? b_less_a : a_less_b;

  logic sign1, opposed1;
  logic [7:0] exponent1;
  logic [4:0] distance1;
  logic [23:0] large1, small1;
  always_ff @(posedge clk) begin
    sign1     <= swap ? !b[31] : a[31];
    opposed1  <= a[31] == b[31];
    exponent1 <= swap ? b_exponent : a_exponent;
    distance1 <= |distance[7:5] ? 5'd31 : distance[4:0];
    large1    <= swap ? {b_normal, b[22:0]} : {a_normal, a[22:0]};
    small1    <= swap ? {a_normal, a[22:0]} : {b_normal, b[22:0]};
  end

  // 2: align, with a guard and a round bit and one for all that is below, and add or subtract.
  logic [26:0] placed, moved, aligned, back;
  assign placed  = {small1, 3'b000};
  assign moved   = placed >> distance1;
  assign back    = 27'h7ffffff << distance1;  // places that stay
  assign aligned = {moved[26:1], moved[0] | |(placed & ~back)};

  logic sign2, opposed2;
  logic [7:0] exponent2;
  logic [27:0] sum2;
  always_ff @(posedge clk) begin
    sign2     <= sign1;
    opposed2  <= opposed1;
    exponent2 <= exponent1;
    sum2      <= opposed1 ? {1'b0, large1, 3'b000} - {1'b0, aligned} :
                            {1'b0, large1, 3'b000} + {1'b0, aligned};
  end

  // 3: where the highest one is among the upper three places, round; it moves by a place at most.
  // Elsewhere the exponents differed by one at most: nothing is lost, and only places count.
  logic back_one;
  logic [23:0] far_mantissa, near_mantissa;
  logic [4:0] near_count;
  logic half, rest, up;
  logic [8:0] far_exponent, near_exponent, far_field, near_field;
  logic [31:0] far, near;

  always_comb begin
    if (sum2[27]) begin
      far_mantissa = sum2[27:4];
      half         = sum2[3];
      rest         = |sum2[2:0];
      far_exponent = 9'(exponent2) + Bias + 1'b1;
    end else if (sum2[26]) begin
      far_mantissa = sum2[26:3];
      half         = sum2[2];
      rest         = |sum2[1:0];
      far_exponent = 9'(exponent2) + Bias;
    end else begin
      far_mantissa = sum2[25:2];
      half         = sum2[1];
      rest         = sum2[0];
      far_exponent = 9'(exponent2) + Bias - 1'b1;
    end
  end
  assign up        = half && (rest || far_mantissa[0]);
  assign far_field = far_mantissa[23] ? far_exponent : '0;
  // A carry out of the fraction is one more in the exponent.
  assign far       = {far_field, far_mantissa[22:0]} + 32'(up);

  ft_normalise normalise (
      .value  (sum2[24:1]),
      .shifted(near_mantissa),
      .count  (near_count)
  );
  assign near_exponent = 9'(exponent2) + (Bias - 9'd2) - 9'(near_count);
  assign near_field    = near_mantissa[23] ? near_exponent : '0;
  assign near          = {near_field, near_mantissa[22:0]};

  assign back_one = |sum2[27:25];
  always_ff @(posedge clk) begin
    // Equal values differ by plus zero.
    difference[32]   <= sign2 && !(opposed2 && sum2 == '0);
    difference[31:0] <= back_one ? far : near;
  end
endmodule
