// SPDX-License-Identifier: Apache-2.0
// The order in which the ways of a set were used, as one bit a pair of ways: the pair (i, j), i < j,
// has a 1 where i was used after j. An update touches each bit in one LUT, whatever the order is,
// and all zeros is a proper order, way 0 the least recent.
module ft_lru #(
    parameter int WAYS = 16
) (
    input  logic [WAYS*(WAYS-1)/2-1:0] order,
    input  logic [WAYS-1:0]            used,    // the way used now: one of them
    output logic [WAYS*(WAYS-1)/2-1:0] updated,
    output logic [WAYS-1:0]            oldest   // least recently used, by `order`
);
  logic [WAYS*WAYS-1:0] after;  // bit WAYS * i + j: way i was used after way j

  for (genvar i = 0; i < WAYS; i = i + 1) begin : gen_way
    for (genvar j = 0; j < WAYS; j = j + 1) begin : gen_other
      if (i < j) begin : gen_pair
        localparam int Pair = i * (2 * WAYS - i - 1) / 2 + j - i - 1;
        assign after[WAYS*i+j] = order[Pair];
        assign after[WAYS*j+i] = !order[Pair];
        assign updated[Pair]   = used[i] || (order[Pair] && !used[j]);
      end
    end
    assign after[WAYS*i+i] = 1'b0;
    assign oldest[i] = after[WAYS*i+:WAYS] == '0;
  end
endmodule
