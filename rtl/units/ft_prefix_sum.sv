// SPDX-License-Identifier: Apache-2.0
// Prefix sum unit (PSU): the exclusive prefix sums of a section and its total, a section a cycle.
// Blelloch's up-sweep and down-sweep, their levels dealt out over the stages; no queues. A stage
// moves where the one before it has room, so that gaps close while the taker waits.
// Docs: docs/accelerator/prefix_sum.md.
module ft_prefix_sum #(
    parameter int WIDTH = 32,
    parameter int SECTION = 32,        // values, a power of two
    parameter int STAGES = 2,          // 2 to 2 * log2(SECTION)
    parameter int VALUE_BITS = WIDTH   // of the values; the bits above have to be zero
) (
    input  logic                     clk,
    input  logic                     rst,
    input  logic                     in_valid,
    output logic                     in_ready,
    input  logic [WIDTH*SECTION-1:0] in_values,
    output logic                     out_valid,
    input  logic                     out_ready,
    output logic [WIDTH*SECTION-1:0] out_sums,
    output logic [WIDTH-1:0]         out_total,
    output logic [3:0]               activity
);
  localparam int Levels = 2 * $clog2(SECTION);
  // Those that make a path long: the root's sum is the total and goes no further, and the first level
  // of the down-sweep has no adders. So the two levels in the middle go with either neighbour.
  localparam int Adders = Levels - 2;

  logic [STAGES-1:0] full, move;  // `move`: takes what the stage before has, or the input

  assign in_ready  = gen_stage[0].ready;
  assign out_valid = full[STAGES-1];
  assign activity  = |move || (out_valid && out_ready) ? ft_pkg::Busy
                     : |full ? ft_pkg::Stalled : ft_pkg::Idle;

  for (genvar s = 0; s < STAGES; s++) begin : gen_stage
    localparam int From = STAGES > Adders ? Levels * s / STAGES
                          : (2 * Adders * s + STAGES) / (2 * STAGES)
                            + (Adders * s > Adders / 2 * STAGES ? 2 : 0);
    localparam int To = STAGES > Adders ? Levels * (s + 1) / STAGES
                        : (2 * Adders * (s + 1) + STAGES) / (2 * STAGES)
                          + (Adders * (s + 1) > Adders / 2 * STAGES ? 2 : 0);
    logic [WIDTH*SECTION-1:0] from_before, swept, values;
    logic [WIDTH-1:0] total_in, total_out, total;
    logic ready;

    if (s == 0) begin : gen_input
      assign from_before = in_values;
      assign total_in    = '0;
      assign move[s]     = in_valid && ready;
    end else begin : gen_between
      assign from_before = gen_stage[s-1].values;
      assign total_in    = gen_stage[s-1].total;
      assign move[s]     = full[s-1] && ready;
    end
    if (s == STAGES - 1) begin : gen_last
      assign ready = !full[s] || out_ready;
    end else begin : gen_chain
      assign ready = !full[s] || gen_stage[s+1].ready;
    end

    ft_prefix_sum_sweep #(
        .WIDTH(WIDTH), .SECTION(SECTION), .VALUE_BITS(VALUE_BITS), .FROM(From), .TO(To)
    ) u_sweep (
        .in_values(from_before), .in_total(total_in), .out_values(swept), .out_total(total_out)
    );

    always_ff @(posedge clk) begin
      if (move[s]) begin
        values <= swept;
        total  <= total_out;
      end
      if (rst) full[s] <= 1'b0;
      else if (ready) full[s] <= move[s];
    end
  end

  assign out_sums  = gen_stage[STAGES-1].values;
  assign out_total = gen_stage[STAGES-1].total;

`ifndef SYNTHESIS
  localparam logic [WIDTH-1:0] Above = {WIDTH{1'b1}} << VALUE_BITS;
  logic held;  // a result that was not taken
  logic [WIDTH-1:0] held_total;

  always_ff @(posedge clk) begin
    held       <= !rst && out_valid && !out_ready;
    held_total <= out_total;
    if (!rst) begin
      assert (!held || (out_valid && out_total == held_total))
      else $error("ft_prefix_sum: a result went away before it was taken");
      for (int i = 0; i < SECTION; i++) begin
        assert (!in_valid || (in_values[WIDTH*i+:WIDTH] & Above) == '0)
        else $error("ft_prefix_sum: a value of more than VALUE_BITS bits");
      end
    end
  end
`endif
endmodule
