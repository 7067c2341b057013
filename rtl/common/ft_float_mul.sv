// SPDX-License-Identifier: Apache-2.0
// a * b * 2^-down in binary32, rounded to nearest even, for those who want its integer part: a product
// below the normal range is zero. a is what ft_float_sub makes, b is zero or normal and finite. A
// product every cycle, ft_pkg::FloatMulLatency (3) cycles later.
module ft_float_mul (
    input  logic        clk,
    input  logic [32:0] a,
    input  logic [31:0] b,
    input  logic [3:0]  down,
    output logic [31:0] product
);
  // Both factors as mantissas, and the product's exponent field where it has its first one in
  // place 46; one more where it is in place 47.
  logic sign0;
  logic [23:0] x, y;
  logic signed [10:0] exponent0;
  assign sign0     = a[32] ^ b[31];
  assign x         = {|a[31:23], a[22:0]};
  assign y         = {|b[30:23], b[22:0]};
  assign exponent0 = 11'(a[31:23]) + 11'(b[30:23]) - 11'd159 - 11'(down);

  // In two parts, each as wide as one multiplier block of an FPGA, and their sum a cycle later: two
  // blocks one behind the other are too slow.
  logic sign1, sign2;
  logic signed [10:0] exponent1, exponent2;
  logic [40:0] lower1;
  logic [30:0] upper1;
  logic [47:0] product2;
  always_ff @(posedge clk) begin
    lower1    <= 41'(x) * 41'(y[16:0]);
    upper1    <= 31'(x) * 31'(y[23:17]);
    sign1     <= sign0;
    exponent1 <= exponent0;
    product2  <= {upper1, 17'd0} + 48'(lower1);
    sign2     <= sign1;
    exponent2 <= exponent1;
  end

  logic upper, under, over, half, up;
  logic [25:0] cut;  // mantissa, half, and whether there is more below
  logic signed [10:0] exponent;
  logic [30:0] kept; // what is rounded, with the exponent's field before it, so that a carry goes there
  assign upper    = product2[47];
  assign cut      = upper ? {product2[47:23], |product2[22:0]} : {product2[46:22], |product2[21:0]};
  assign exponent = exponent2 + 11'(upper);
  assign under    = exponent <= 0 || !cut[25];
  assign over     = exponent >= 255;
  assign kept     = under ? '0 : {exponent[7:0], cut[24:2]};
  assign half     = cut[1] && !under;
  assign up       = half && (cut[0] || kept[0]);
  always_ff @(posedge clk) begin
    product <= {sign2, over ? 31'h7f800000 : kept + 31'(up)};
  end
endmodule
