// SPDX-License-Identifier: Apache-2.0
// a * b in binary32, rounded to nearest even, of finite values. A product every cycle.
//
// Without WIDE: 5 cycles later; subnormals in full, of factors and product. With WIDE: ft_pkg::FloatMulLatency (3) cycles later; a is
// what ft_float_sub makes with WIDE, b is zero or normal, and a product below the normal range is
// zero: for those who want its integer part.
module ft_float_mul #(
    parameter int WIDE = 0
) (
    input  logic             clk,
    input  logic [31+WIDE:0] a,
    input  logic [31:0]      b,
    output logic [31:0]      product
);
  // Both factors as mantissas, and the product's exponent field where it has its first one in
  // place 46; one more where it is in place 47.
  logic sign0;
  logic [23:0] x, y;
  logic signed [10:0] exponent0;

  if (WIDE != 0) begin : g_wide
    assign sign0     = a[32] ^ b[31];
    assign x         = {|a[31:23], a[22:0]};
    assign y         = {|b[30:23], b[22:0]};
    assign exponent0 = 11'(a[31:23]) + 11'(b[30:23]) - 11'd159;
  end else begin : g_normalise
    // One factor at most is worth normalising: the product of two subnormals is zero.
    logic exchange;
    logic [30:0] first, second;
    logic [23:0] mantissa;
    logic [4:0] count;
    assign exchange = b[30:23] == '0;
    assign first    = exchange ? b[30:0] : a[30:0];
    assign second   = exchange ? a[30:0] : b[30:0];
    ft_normalise normalise (
        .value  ({|first[30:23], first[22:0]}),
        .stop   (24'd0),
        .shifted(mantissa),
        .count  (count)
    );
    always_ff @(posedge clk) begin
      sign0     <= a[31] ^ b[31];
      x         <= mantissa;
      y         <= {|second[30:23], second[22:0]};
      exponent0 <= 11'({first[30:24], first[23] | ~|first[30:23]}) - 11'(count) +
                   11'({second[30:24], second[23] | ~|second[30:23]}) - 11'd127;
    end
  end

  // The product has two registers behind it, which multiplier blocks have inside.
  logic sign1, sign2;
  logic signed [10:0] exponent1, exponent2;
  logic [47:0] product1, product2;
  always_ff @(posedge clk) begin
    product1  <= x * y;
    sign1     <= sign0;
    exponent1 <= exponent0;
    product2  <= product1;
    sign2     <= sign1;
    exponent2 <= exponent1;
  end

  logic upper;
  logic [25:0] cut;  // mantissa, half, and whether there is more below
  logic signed [10:0] exponent;
  assign upper    = product2[47];
  assign cut      = upper ? {product2[47:23], |product2[22:0]} : {product2[46:22], |product2[21:0]};
  assign exponent = exponent2 + 11'(upper);

  // What is rounded: with the exponent's field before it, so that a carry goes into it.
  logic sign3, over, up;
  logic [30:0] kept;
  logic half, rest;
  if (WIDE != 0) begin : g_flush
    logic under;
    assign sign3 = sign2;
    assign under = exponent <= 0 || !cut[25];
    assign over  = exponent >= 255;
    assign kept  = under ? '0 : {exponent[7:0], cut[24:2]};
    assign half  = cut[1] && !under;
    assign rest  = cut[0];
  end else begin : g_subnormal
    // Below the normal range the mantissa moves to the right.
    logic signed [10:0] below;
    logic [4:0] distance;
    logic [25:0] moved, stay;
    assign below    = 11'sd1 - exponent;
    assign distance = below <= 0 ? 5'd0 : below > 26 ? 5'd26 : below[4:0];
    assign moved    = cut >> distance;
    assign stay     = 26'h3ffffff << distance;
    always_ff @(posedge clk) begin
      sign3 <= sign2;
      over  <= exponent >= 255 && cut[25];
      kept  <= {moved[25] ? exponent[7:0] : 8'd0, moved[24:2]};
      half  <= moved[1];
      rest  <= moved[0] || |(cut & ~stay);
    end
  end

  assign up = half && (rest || kept[0]);
  always_ff @(posedge clk) begin
    product <= {sign3, over ? 31'h7f800000 : kept + 31'(up)};
  end
endmodule
