// SPDX-License-Identifier: Apache-2.0
// Behind the Morton code generation units: takes their pairs in the order of the triangles, counts
// the digits of the first sorting round on the way, and writes them to memory, code first.
module ft_pair_writer #(
    parameter int UNITS = 4,
    parameter int COMBINE = 32,        // bytes of a block: 8 to 64
    parameter int PAIRS_PER_CYCLE = 2, // 1 or 2
    parameter int RADIX_BITS = 4       // of a digit
) (
    input  logic                          clk,
    input  logic                          rst,
    input  logic                          start,
    input  logic [31:0]                   addr,         // multiple of 8
    input  logic [31:0]                   triangles,
    input  logic [31:0]                   capacity,     // pairs that there is room for
    input  logic [2*UNITS-1:0]            pair_count,   // of each unit, as in ft_morton_code
    input  logic [65*UNITS-1:0]           pair0,
    input  logic [65*UNITS-1:0]           pair1,
    output logic [2*UNITS-1:0]            pair_take,
    output logic                          wr_valid,
    input  logic                          wr_ready,
    output logic [31:0]                   wr_addr,
    output logic [6:0]                    wr_bytes,
    output logic [8*COMBINE-1:0]          wr_data,
    output logic [31:0]                   written,      // pairs
    output logic [32*(1<<RADIX_BITS)-1:0] counts,       // of pairs written, by digit; valid with done
    output logic                          overflow,     // there were more pairs than capacity
    output logic                          done,
    output logic [3:0]                    activity      // stalled on: bus
);
  localparam int Slots = COMBINE / 8;
  localparam int BlockBits = $clog2(COMBINE);
  localparam int PlaceBits = Slots > 1 ? $clog2(Slots) : 1;
  localparam int UnitBits = UNITS > 1 ? $clog2(UNITS) : 1;
  localparam int Digits = 1 << RADIX_BITS;
  localparam logic [PlaceBits-1:0] LastPlace = PlaceBits'(Slots - 1);
  localparam logic [UnitBits-1:0] LastUnit = UnitBits'(UNITS - 1);

  // Whose turn it is, and what the two units next in turn hold.
  logic [UnitBits-1:0] unit, unit1, unit2;
  logic [64:0] front, behind, other, second;
  logic [1:0] front_count, other_count;
  assign unit1 = unit == LastUnit ? '0 : unit + 1'b1;
  assign unit2 = unit1 == LastUnit ? '0 : unit1 + 1'b1;
  for (genvar i = 0; i < 65; i++) begin : g_bit
    logic [(1<<UnitBits)-1:0] bits0, bits1;
    for (genvar u = 0; u < (1 << UnitBits); u++) begin : g_unit
      assign bits0[u] = u < UNITS && pair0[65*(u%UNITS)+i];
      assign bits1[u] = u < UNITS && pair1[65*(u%UNITS)+i];
    end
    assign front[i]  = bits0[unit];
    assign behind[i] = bits1[unit];
    assign other[i]  = bits0[unit1];
  end
  logic [(2<<UnitBits)-1:0] all_counts;
  assign all_counts  = (2 << UnitBits)'(pair_count);
  assign front_count = all_counts[2*unit+:2];
  assign other_count = all_counts[2*unit1+:2];

  // The first pair, and the second: of the same triangle, or the first of the next unit's.
  logic [31:0] left;  // triangles whose last pair has not come
  logic change, have0, have1, fits0, fits1, take0, take1;
  logic [PlaceBits-1:0] place, from;  // slots of the block: of the next pair, of the first one held
  assign change = front[64] && UNITS > 1;
  assign second = change ? other : behind;
  assign have0  = left != '0 && front_count != '0;
  assign have1  = have0 && PAIRS_PER_CYCLE > 1 && Slots > 1 &&
                  (change ? other_count != '0 : front_count[1]) && !(front[64] && left == 32'd1);
  // One request a cycle: of the pair that completes a block.
  assign fits0  = place != LastPlace || wr_ready;
  assign fits1  = place != LastPlace - 1'b1 || wr_ready;
  assign take0  = have0 && fits0;
  assign take1  = take0 && have1 && fits1;

  always_comb begin
    pair_take = '0;
    for (int u = 0; u < UNITS; u++) begin
      if (unit == UnitBits'(u)) pair_take[2*u+:2] = {take1 && !change, take0 && !(take1 && !change)};
      else if (unit1 == UnitBits'(u)) pair_take[2*u+:2] = {1'b0, take1 && change};
    end
  end

  // Of the pairs taken those are kept for which there is room.
  logic [31:0] room;
  logic room0, room1, keep0, keep1, flush;
  assign room0 = room != '0;
  assign room1 = room0 && room != 32'd1;
  assign keep0 = take0 && room0;
  assign keep1 = take1 && room1;

  logic [31-BlockBits:0] block_at;
  logic holds;
  assign holds    = place != from;
  assign flush    = left == '0 && holds;
  assign wr_valid = flush || (have0 && room0 && place == LastPlace) ||
                    (have1 && room1 && place == LastPlace - 1'b1);
  assign wr_addr  = {block_at, BlockBits'(0)} | (32'(from) << 3);
  assign wr_bytes = 7'(((flush ? 32'(place) : 32'(Slots)) - 32'(from)) << 3);
  // Places behind the last pair of a block that is not full are of no concern.
  for (genvar s = 0; s < Slots; s++) begin : g_slot
    if (s == Slots - 1) begin : g_last
      assign wr_data[64*s+:64] = place == LastPlace ? front[63:0] : second[63:0];
    end else begin : g_held
      logic [63:0] held;
      assign wr_data[64*s+:64] = s == Slots - 2 && place != LastPlace ? front[63:0] : held;
      always_ff @(posedge clk) begin
        if (keep0 && place == PlaceBits'(s)) held <= front[63:0];
        else if (keep1 && place == PlaceBits'(s - 1)) held <= second[63:0];
      end
    end
  end

  logic put, full;
  assign put  = wr_valid && wr_ready;
  assign full = put && !flush;

  // Digits are counted a cycle later: the pairs have come a long way.
  logic digit_valid0, digit_valid1;
  logic [RADIX_BITS-1:0] digit0, digit1;
  for (genvar d = 0; d < Digits; d++) begin : g_count
    logic [31:0] count;
    logic [1:0] more;
    assign more = 2'(digit_valid0 && digit0 == RADIX_BITS'(d)) +
                  2'(digit_valid1 && digit1 == RADIX_BITS'(d));
    always_ff @(posedge clk) begin
      if (start) count <= '0;
      else count <= count + 32'(more);
    end
    assign counts[32*d+:32] = count;
  end

  always_ff @(posedge clk) begin
    digit0       <= front[RADIX_BITS-1:0];
    digit1       <= second[RADIX_BITS-1:0];
    digit_valid0 <= keep0;
    digit_valid1 <= keep1;
    if (start) begin
      unit     <= '0;
      left     <= triangles;
      room     <= capacity;
      written  <= '0;
      overflow <= 1'b0;
      block_at <= addr[31:BlockBits];
      place    <= PlaceBits'((addr >> 3) & 32'(Slots - 1));
      from     <= PlaceBits'((addr >> 3) & 32'(Slots - 1));
    end else begin
      if (take1 && front[64] && second[64]) unit <= unit2;
      else if ((take0 && front[64]) || (take1 && second[64])) unit <= unit1;
      left     <= left - 32'(take0 && front[64]) - 32'(take1 && second[64]);
      room     <= room - 32'(keep0) - 32'(keep1);
      written  <= written + 32'(keep0) + 32'(keep1);
      if ((take0 && !room0) || (take1 && !room1)) overflow <= 1'b1;
      if (flush && put) place <= from;
      else place <= PlaceBits'((32'(place) + 32'(keep0) + 32'(keep1)) & 32'(Slots - 1));
      if (full) begin
        from     <= '0;
        block_at <= block_at + 1'b1;
      end
    end
    if (rst) begin
      left         <= '0;
      place        <= '0;
      from         <= '0;
      digit_valid0 <= 1'b0;
      digit_valid1 <= 1'b0;
    end
  end

  assign done = left == '0 && !holds && !digit_valid0;
  assign activity = take0 || (flush && wr_ready) || digit_valid0 ? ft_pkg::Busy :
                    have0 || flush ? ft_pkg::Stalled : ft_pkg::Idle;

`ifndef SYNTHESIS
  always_ff @(posedge clk) begin
    if (!rst) begin
      assert (!start || done) else $error("ft_pair_writer: started before it was done");
      assert (!start || addr[2:0] == '0) else $error("ft_pair_writer: a base that no pair fits");
      assert (!put || wr_bytes != '0) else $error("ft_pair_writer: an empty request");
    end
  end
`endif
endmodule
