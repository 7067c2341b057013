// SPDX-License-Identifier: Apache-2.0
// ft_lru with the cache's sixteen ways, piece by piece, where lru.sv takes eight as a whole: a pair of
// ways changes when one of the two is used, and then as it should; any three ways that were in an order
// are in one again. So all sixteen are, for the first order (all zeros) is one, and an order of ways has
// one oldest, which is the way that all others were used after.
// engine: sat
// sources: units/ft_lru.sv
// fault: units/ft_lru.sv: used[i] || (order[Pair] && !used[j]) => used[i] || order[Pair]
// fault: units/ft_lru.sv: after[WAYS*j+i] = !order[Pair] => after[WAYS*j+i] = order[Pair]
// fault: units/ft_lru.sv: after[WAYS*i+:WAYS] == '0 => after[WAYS*i+:WAYS-1] == '0
module proof (
    input logic [119:0] order,
    input logic [  3:0] use_way
);
  localparam int Ways = 16;
  logic [119:0] updated;
  logic [Ways-1:0] used, oldest, all_after;
  logic [Ways*Ways-1:0] before, next;  // bit 16 * i + j: way i was used after way j

  assign used = 16'd1 << use_way;
  ft_lru #(.WAYS(Ways)) dut (.order, .used, .updated, .oldest);

  for (genvar i = 0; i < Ways; i++) begin : way
    assign before[Ways*i+i] = 1'b0;
    assign next[Ways*i+i]   = 1'b0;
    for (genvar j = i + 1; j < Ways; j++) begin : pair
      localparam int Place = i * (2 * Ways - i - 1) / 2 + j - i - 1;
      assign before[Ways*i+j] = order[Place];
      assign before[Ways*j+i] = !order[Place];
      assign next[Ways*i+j]   = updated[Place];
      assign next[Ways*j+i]   = !updated[Place];
    end
  end

  always_comb begin
    for (int i = 0; i < Ways; i++) begin
      all_after[i] = 1'b1;
      for (int j = 0; j < Ways; j++) begin
        if (i != j && !before[Ways*j+i]) all_after[i] = 1'b0;
      end
      assert (oldest[i] == all_after[i]);
      for (int j = i + 1; j < Ways; j++) begin
        assert (next[Ways*i+j] == (used[i] || (before[Ways*i+j] && !used[j])));
        for (int k = j + 1; k < Ways; k++) begin
          // Not round in a circle, either way.
          if (before[Ways*i+j] != before[Ways*j+k] || before[Ways*j+k] != before[Ways*k+i])
            assert (next[Ways*i+j] != next[Ways*j+k] || next[Ways*j+k] != next[Ways*k+i]);
        end
      end
    end
  end
endmodule
