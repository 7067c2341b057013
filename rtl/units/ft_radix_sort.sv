// SPDX-License-Identifier: Apache-2.0
// Radix sort unit (RSU): control of the rounds of counting sort over the prefix sum units.
// Of a section, fetched from the stream, the units sum the flags of each digit in turn: its pairs'
// ranks. Then two pairs a cycle go to their places, through a block a digit.
// Docs: docs/accelerator/radix_sort.md.
module ft_radix_sort #(
    parameter int BUS_BYTES = 16,
    parameter int UNITS = 4,       // prefix sum units, a power of two
    parameter int SECTION = 32,    // pairs a unit; at least a digit's values
    parameter int RADIX_BITS = 4,
    parameter int COMBINE = 32     // bytes of a block
) (
    input  logic                         clk,
    input  logic                         rst,
    input  logic                         start,
    input  logic [3:0]                   round,
    input  logic                         last,           // codes and ids go to arrays of their own
    input  logic [31:0]                  pairs,
    input  logic [31:0]                  to,             // pairs, or codes in the last round
    input  logic [31:0]                  to_ids,
    input  logic                         use_counts_in,  // else those counted by the round before
    input  logic [(32<<RADIX_BITS)-1:0]  counts_in,
    input  logic                         rd_valid,
    output logic                         rd_ready,
    input  logic [8*BUS_BYTES-1:0]       rd_data,
    output logic                         wr_valid,
    input  logic                         wr_ready,
    output logic [31:0]                  wr_addr,
    output logic [6:0]                   wr_bytes,
    output logic [8*COMBINE-1:0]         wr_data,
    output logic [UNITS-1:0]             psu_in_valid,
    input  logic [UNITS-1:0]             psu_in_ready,
    output logic [UNITS*SECTION*32-1:0]  psu_in_values,
    input  logic [UNITS-1:0]             psu_out_valid,
    output logic [UNITS-1:0]             psu_out_ready,
    input  logic [UNITS*SECTION*32-1:0]  psu_out_sums,
    input  logic [32*UNITS-1:0]          psu_out_total,
    output logic                         done,
    output logic [3:0]                   activity
);
  localparam int Radix = 1 << RADIX_BITS;
  localparam int Rounds = 32 / RADIX_BITS;
  localparam int Pairs = UNITS * SECTION;       // of a section
  localparam int PairBits = $clog2(Pairs);
  localparam int RankBits = $clog2(SECTION);
  localparam int OwnBits = RankBits + 1;        // of a unit's total
  localparam int Lanes = BUS_BYTES / 8;         // pairs of a beat
  localparam int Columns = Lanes > 2 ? Lanes : 2;
  localparam int RowBits = $clog2(Pairs / Columns);
  localparam int GroupBits = PairBits - 1;      // of two pairs
  localparam int ItemBits = 64 + RADIX_BITS;

  if (Radix > SECTION) begin : gen_radix
    $error("a section has to hold the counts of all digits");
  end

  // Reasons to stall, as in the model.
  localparam logic [3:0] BusRead = 4'd0, BusWrite = 4'd1, PrefixSum = 4'd2;

  typedef enum logic [3:0] {Idle, Ask, Bases, Fetch, Scan, Scatter, Drain, Flush, Finish} state_t;
  state_t state;

  logic [RADIX_BITS-1:0] step;    // digits: written begins, summed flags, flushed blocks
  logic [RADIX_BITS:0] asked;     // digits whose flags have been made
  logic [31:0] left;              // pairs to be fetched
  logic [PairBits:0] loaded;      // pairs of the section
  logic fetch, section_full, begins_valid, collect, issue, last_group;

  // ---- Counts of the digits: of this round until they are summed, then of the next.
  logic [32*Radix-1:0] counts;
  logic [1:0] counted;            // what has left the first register in the cycle before
  logic [2*RADIX_BITS-1:0] counted_digits;
  logic clear_counts;

  for (genvar d = 0; d < Radix; d++) begin : gen_count
    logic [1:0] hit;
    for (genvar k = 0; k < 2; k++) begin : gen_hit
      assign hit[k] = counted[k] && counted_digits[RADIX_BITS*k+:RADIX_BITS] == RADIX_BITS'(d);
    end
    always_ff @(posedge clk) begin
      if (clear_counts) counts[32*d+:32] <= '0;
      else if (start && use_counts_in) counts[32*d+:32] <= counts_in[32*d+:32];
      else counts[32*d+:32] <= counts[32*d+:32] + {30'd0, &hit, ^hit};
    end
  end

  // ---- Fetch: a beat into the section, and its digits where the flags are made.
  logic [PairBits-1:0] beat;
  logic [Lanes-1:0] present;                    // pairs of the beat that are in the array
  logic [Lanes*RADIX_BITS-1:0] digits_in;
  logic [Pairs*RADIX_BITS-1:0] digits;
  logic [Pairs-1:0] valid;
  logic [Pairs-1:0] flags;                      // of the digit that the units see, through a register
  logic flags_valid, make;
  logic asking;                                 // in state Ask, from a register of its own
  // Ranks among the pairs of a unit with the same digit. Bit b of all of them lies together, so that
  // a pair's is chosen without a multiplication: [Pairs * b + pair].
  logic [RankBits*Pairs-1:0] ranks;

  assign rd_ready     = state == Fetch;
  assign fetch        = rd_valid && rd_ready;
  assign section_full = beat == PairBits'(Pairs / Lanes - 1) || left <= 32'(Lanes);

  for (genvar l = 0; l < Lanes; l++) begin : gen_in
    always_comb begin
      digits_in[RADIX_BITS*l+:RADIX_BITS] = '0;
      for (int r = 0; r < Rounds; r++) begin
        if (round == 4'(r)) digits_in[RADIX_BITS*l+:RADIX_BITS] = rd_data[64*l+RADIX_BITS*r+:RADIX_BITS];
      end
    end
    assign present[l] = left > 32'(l);
  end

  for (genvar p = 0; p < Pairs; p++) begin : gen_pair
    logic [RADIX_BITS-1:0] digit;
    assign digit = digits[RADIX_BITS*p+:RADIX_BITS];
    always_ff @(posedge clk) begin
      if (fetch && beat == PairBits'(p / Lanes)) begin
        digits[RADIX_BITS*p+:RADIX_BITS] <= digits_in[RADIX_BITS*(p%Lanes)+:RADIX_BITS];
      end
      if (start) flags[p] <= 1'b0;  // no values behind the counts
      else if (make) flags[p] <= valid[p] && digit == asked[RADIX_BITS-1:0];
      if (start || (issue && last_group)) valid[p] <= 1'b0;
      else if (fetch && beat == PairBits'(p / Lanes)) valid[p] <= present[p%Lanes];
    end
    for (genvar b = 0; b < RankBits; b++) begin : gen_rank
      always_ff @(posedge clk) begin
        if (collect && digit == step) ranks[Pairs*b+p] <= psu_out_sums[32*p+b];
      end
    end
    // To the units: flags, or before the first section the counts to the first of them.
    if (p < Radix) begin : gen_values
      assign psu_in_values[32*p+:32] = asking ? counts[32*p+:32] : {31'd0, flags[p]};
    end else begin : gen_flag
      assign psu_in_values[32*p+:32] = {31'd0, flags[p]};
    end
  end

  // The section's pairs, each with its digit.
  logic [GroupBits-1:0] group;                  // the next to be scattered
  logic [GroupBits-1:0] final_group;            // of the section
  logic [Columns*ItemBits-1:0] row_items;

  for (genvar c = 0; c < Columns; c++) begin : gen_column
    localparam int Lane = c % Lanes;
    logic [ItemBits-1:0] items[0:Pairs/Columns-1];
    logic write;
    logic [RowBits-1:0] row;
    if (Lanes == 1) begin : gen_half
      assign write = fetch && beat[0] == 1'(c);
      assign row   = beat[RowBits:1];
    end else begin : gen_whole
      assign write = fetch;
      assign row   = beat[RowBits-1:0];
    end
    always_ff @(posedge clk) begin
      if (write) begin
        items[row] <= {digits_in[RADIX_BITS*Lane+:RADIX_BITS], rd_data[64*Lane+:64]};
      end
    end
    assign row_items[ItemBits*c+:ItemBits] = items[group[GroupBits-1-:RowBits]];
  end

  // ---- Scan: the units' totals are the parts of the digit's pairs in the section.
  logic add_valid;                              // to the digit's begin, a cycle later
  logic [RADIX_BITS-1:0] add_digit;
  logic [PairBits:0] add_count;

  assign psu_in_valid  = {{(UNITS - 1) {flags_valid}}, flags_valid || asking};
  assign psu_out_ready = {{(UNITS - 1) {state == Scan}},
                          state == Scan || (state == Bases && step == RADIX_BITS'(Radix - 1))};
  assign begins_valid  = state == Bases && psu_out_valid[0];
  // No place may be on its way from a begin that changes.
  logic reading;
  assign make    = state == Scan && !asked[RADIX_BITS] && !reading && (!flags_valid || psu_in_ready[0]);
  assign collect = state == Scan && psu_out_valid[0];
  assign clear_counts = asking && psu_in_ready[0];

  for (genvar u = 0; u < UNITS; u++) begin : gen_rest
    logic [PairBits:0] own, rest;               // pairs of the digit in this unit; and those behind it
    assign own = {{(PairBits + 1 - OwnBits) {1'b0}}, psu_out_total[32*u+:OwnBits]};
    if (u == UNITS - 1) begin : gen_last
      assign rest = own;
    end else begin : gen_sum
      assign rest = own + gen_rest[u+1].rest;
    end
  end

  // ---- Scatter. First register: two pairs with rank and rest; the place is begin - rest + rank,
  // since the begin is already the next section's. Second register: the place.
  logic advance;                                // both registers
  logic [1:0] a_valid, b_valid;
  logic [2*RADIX_BITS-1:0] a_digits, b_digits;
  logic [127:0] a_items, b_items;               // code and id of each
  logic [2*RankBits-1:0] a_ranks;
  logic [2*(PairBits+1)-1:0] a_rests;
  logic [63:0] places, b_places;
  logic blocks_ready;

  assign reading    = |a_valid;
  assign advance    = b_valid == '0 || blocks_ready;
  assign issue      = state == Scatter && advance;
  assign last_group = group == final_group;

  // ---- Where the next section's pairs of a digit begin.
  logic [31:0] begins[0:Radix-1];
  logic [31:0] begin_now, begin_next;
  logic [RADIX_BITS-1:0] begin_digit;
  logic begin_write;

  assign begin_digit = state == Bases || state == Flush ? step : add_digit;
  assign begin_now   = begins[begin_digit];
  assign begin_write = begins_valid || add_valid;
  assign begin_next  = state == Bases ? psu_out_sums[32*32'(step)+:32]
                                      : begin_now + {{(31 - PairBits) {1'b0}}, add_count};

  always_ff @(posedge clk) begin
    if (begin_write) begins[begin_digit] <= begin_next;
  end

  for (genvar k = 0; k < 2; k++) begin : gen_move
    logic [ItemBits-1:0] item;
    logic [RADIX_BITS-1:0] digit;
    logic [RankBits-1:0] rank;
    logic [UNITS*(PairBits+1)-1:0] digit_rests;
    logic [PairBits:0] rest;
    logic [RADIX_BITS-1:0] next_digit;

    always_comb begin
      item = row_items[ItemBits*k+:ItemBits];
      for (int c = 2; c < Columns; c += 2) begin
        if (32'(group) % (Columns / 2) == c / 2) item = row_items[ItemBits*(c+k)+:ItemBits];
      end
    end
    assign digit = item[64+:RADIX_BITS];

    for (genvar b = 0; b < RankBits; b++) begin : gen_rank
      logic [Pairs-1:0] plane;
      assign plane   = ranks[Pairs*b+:Pairs];
      assign rank[b] = plane[{group, 1'(k)}];
    end

    // A copy for each of the two pairs: a LUT RAM has one port to read.
    for (genvar u = 0; u < UNITS; u++) begin : gen_unit
      logic [PairBits:0] unit_rests[0:Radix-1];
      always_ff @(posedge clk) begin
        if (collect) unit_rests[step] <= gen_rest[u].rest;
      end
      assign digit_rests[(PairBits+1)*u+:PairBits+1] = unit_rests[digit];
    end
    always_comb begin
      rest = digit_rests[PairBits:0];
      for (int u = 1; u < UNITS; u++) begin
        if (32'(group) >> (RankBits - 1) == u) rest = digit_rests[(PairBits+1)*u+:PairBits+1];
      end
    end

    always_ff @(posedge clk) begin
      counted_digits[RADIX_BITS*k+:RADIX_BITS] <= next_digit;
      if (advance) begin
        a_items[64*k+:64]                      <= item[63:0];
        a_digits[RADIX_BITS*k+:RADIX_BITS]     <= digit;
        a_ranks[RankBits*k+:RankBits]          <= rank;
        a_rests[(PairBits+1)*k+:PairBits+1]    <= rest;
        b_items[64*k+:64]                      <= a_items[64*k+:64];
        b_digits[RADIX_BITS*k+:RADIX_BITS]     <= a_digits[RADIX_BITS*k+:RADIX_BITS];
        b_places[32*k+:32]                     <= places[32*k+:32];
      end
    end
    assign places[32*k+:32] = begins[a_digits[RADIX_BITS*k+:RADIX_BITS]]
                              + {{(31 - PairBits) {1'b1}}, {{(PairBits + 1 - RankBits) {1'b0}},
                                 a_ranks[RankBits*k+:RankBits]} - a_rests[(PairBits+1)*k+:PairBits+1]};
    // The next round's digit; in the last one nobody looks at it.
    always_comb begin
      next_digit = '0;
      for (int r = 1; r < Rounds; r++) begin
        if (round == 4'(r - 1)) next_digit = a_items[64*k+RADIX_BITS*r+:RADIX_BITS];
      end
    end
  end

  // ---- Blocks.
  logic blocks_empty, flush_ready;
  ft_digit_blocks #(
      .RADIX_BITS(RADIX_BITS), .COMBINE(COMBINE)
  ) u_blocks (
      .clk(clk), .rst(rst), .start(start), .last(last), .to(to), .to_ids(to_ids),
      .begin_valid(begins_valid), .begin_digit(step), .begin_place(begin_next),
      .in_valid(b_valid), .in_ready(blocks_ready), .in_digits(b_digits), .in_places(b_places),
      .in_codes({b_items[64+:32], b_items[0+:32]}), .in_ids({b_items[96+:32], b_items[32+:32]}),
      .flush_valid(state == Flush), .flush_ready(flush_ready), .flush_digit(step),
      .flush_place(begin_now), .empty(blocks_empty),
      .wr_valid(wr_valid), .wr_ready(wr_ready), .wr_addr(wr_addr), .wr_bytes(wr_bytes),
      .wr_data(wr_data)
  );

  // ---- Control.
  logic last_step, drained;
  assign last_step = step == RADIX_BITS'(Radix - 1);
  assign drained   = a_valid == '0 && b_valid == '0 && blocks_empty;
  assign done      = state == Idle;

  always_ff @(posedge clk) begin
    add_valid <= collect && !rst;
    add_digit <= step;
    add_count <= gen_rest[0].rest;
    counted   <= advance ? a_valid : '0;
    // The scan leaves time for it.
    final_group <= GroupBits'((loaded - 1'b1) >> 1);
    flags_valid <= !rst && (make || (flags_valid && !psu_in_ready[0]));
    if (rst) begin
      state   <= Idle;
      asking  <= 1'b0;
      a_valid <= '0;
      b_valid <= '0;
    end else begin
      if (advance) begin
        b_valid <= a_valid;
        a_valid <= {issue && !(last_group && loaded[0]), issue};
      end
      unique case (state)
        Idle: begin
          step   <= '0;
          asked  <= '0;
          beat   <= '0;
          group  <= '0;
          loaded <= '0;
          if (start) begin
            state  <= Ask;
            asking <= 1'b1;
            left   <= pairs;
          end
        end
        Ask:
        if (psu_in_ready[0]) begin
          state  <= Bases;
          asking <= 1'b0;
        end
        Bases:
        if (begins_valid) begin
          step <= step + 1'b1;
          if (last_step) state <= left == '0 ? Drain : Fetch;
        end
        Fetch:
        if (fetch) begin
          beat   <= section_full ? '0 : beat + 1'b1;
          left   <= left <= 32'(Lanes) ? '0 : left - 32'(Lanes);
          loaded <= loaded + (left <= 32'(Lanes) ? left[PairBits:0] : (PairBits + 1)'(Lanes));
          if (section_full) state <= Scan;
        end
        Scan: begin
          if (make) asked <= asked + 1'b1;
          if (collect) step <= step + 1'b1;
          if (collect && last_step) begin
            state <= Scatter;
            asked <= '0;
          end
        end
        Scatter:
        if (issue) begin
          group <= last_group ? '0 : group + 1'b1;
          if (last_group) begin
            loaded <= '0;
            state  <= left == '0 ? Drain : Fetch;
          end
        end
        Drain: if (drained) state <= Flush;
        Flush:
        if (flush_ready) begin
          step <= step + 1'b1;
          if (last_step) state <= Finish;
        end
        default: if (blocks_empty) state <= Idle;  // Finish
      endcase
    end
  end

  always_comb begin
    unique case (state)
      Idle:    activity = ft_pkg::Idle;
      Ask:     activity = psu_in_ready[0] ? ft_pkg::Busy : ft_pkg::Stalled + PrefixSum;
      Bases:   activity = psu_out_valid[0] ? ft_pkg::Busy : ft_pkg::Stalled + PrefixSum;
      Fetch:   activity = rd_valid ? ft_pkg::Busy : ft_pkg::Stalled + BusRead;
      Scan:    activity = collect || make || (flags_valid && psu_in_ready[0]) ? ft_pkg::Busy
                          : ft_pkg::Stalled + (reading ? BusWrite : PrefixSum);
      Scatter: activity = issue ? ft_pkg::Busy : ft_pkg::Stalled + BusWrite;
      Drain:   activity = drained ? ft_pkg::Busy : ft_pkg::Stalled + BusWrite;
      Flush:   activity = flush_ready ? ft_pkg::Busy : ft_pkg::Stalled + BusWrite;
      default: activity = blocks_empty ? ft_pkg::Busy : ft_pkg::Stalled + BusWrite;
    endcase
  end

`ifndef SYNTHESIS
  always_ff @(posedge clk) begin
    if (!rst) begin
      assert (!start || done) else $error("ft_radix_sort: started while it works");
      // The units have the same to do in the same cycles.
      assert (state != Scan || ((&psu_in_ready || !(|psu_in_ready)) && (&psu_out_valid || !(|psu_out_valid))))
      else $error("ft_radix_sort: the prefix sum units are not in step");
      for (int u = 0; u < UNITS; u++) begin
        assert (!collect || psu_out_total[32*u+:32] <= 32'(SECTION))
        else $error("ft_radix_sort: more flags than pairs");
      end
      assert (!add_valid || a_valid == '0) else $error("ft_radix_sort: a begin changes under a place");
    end
  end
`endif
endmodule
