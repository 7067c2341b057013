// SPDX-License-Identifier: Apache-2.0
// ft_lru: the order of use is an order for ever, the way used last comes last in it, all others keep
// their order, and the oldest is the one used least recently. Eight ways: with the sixteen of the cache
// it takes too long. One step is enough:
// the ranks stand for any order, and the first order (all zeros) is one.
// engine: sat
// sources: units/ft_lru.sv
// fault: units/ft_lru.sv: used[i] || (order[Pair] && !used[j]) => used[i] || order[Pair]
// fault: units/ft_lru.sv: used[i] || (order[Pair] && !used[j]) => (used[i] || order[Pair]) && !used[j] && i != 3
// fault: units/ft_lru.sv: after[WAYS*j+i] = !order[Pair] => after[WAYS*j+i] = order[Pair]
module proof (
    input logic [31:0] ranks,  // 4 bits a way: 0 the oldest
    input logic [ 2:0] use_way
);
  localparam int Ways = 8;
  localparam int Pairs = Ways * (Ways - 1) / 2;
  logic [Pairs-1:0] order, expected, updated;
  logic [Ways-1:0] used, oldest;
  logic [31:0] next;
  logic distinct;

  assign used = 8'd1 << use_way;
  ft_lru #(.WAYS(Ways)) dut (.order, .used, .updated, .oldest);

  for (genvar i = 0; i < Ways; i++) begin : way
    // Move to the front: what was more recent than the way used goes down by one.
    assign next[4*i+:4] = 32'(use_way) == i ? 4'd7 :
                          ranks[4*i+:4] > ranks[4*use_way+:4] ? ranks[4*i+:4] - 4'd1 : ranks[4*i+:4];
    for (genvar j = i + 1; j < Ways; j++) begin : pair
      localparam int Place = i * (2 * Ways - i - 1) / 2 + j - i - 1;
      assign order[Place]    = ranks[4*i+:4] > ranks[4*j+:4];
      assign expected[Place] = next[4*i+:4] > next[4*j+:4];
    end
  end
  // Eight different numbers below eight: a permutation.
  always_comb begin
    distinct = 1'b1;
    for (int i = 0; i < Ways; i++) begin
      if (ranks[4*i+3]) distinct = 1'b0;
      for (int j = i + 1; j < Ways; j++) begin
        if (ranks[4*i+:4] == ranks[4*j+:4]) distinct = 1'b0;
      end
    end
    if (distinct) begin
      assert (updated == expected);
      for (int i = 0; i < Ways; i++) begin
        assert (oldest[i] == (ranks[4*i+:4] == 4'd0));
        for (int j = i + 1; j < Ways; j++) assert (next[4*i+:4] != next[4*j+:4]);
      end
    end
  end
endmodule
