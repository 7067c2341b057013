// SPDX-License-Identifier: Apache-2.0
// Brings the triangles in from memory: coordinates by axis to the SBCUs in step 1, whole triangles
// to the MCGUs, in turn, in step 2.
//
// Both are read from one ring of INPUTS corners, into which every word of the stream goes at its
// own place: all of an axis' values in it are a group, three corners in a row are a triangle.
module ft_scene_reader #(
    parameter int BUS_BYTES = 16,  // words of it: at most INPUTS
    parameter int INPUTS    = 8,   // coordinates of a group: a power of two, at least 4
    parameter int UNITS     = 4    // MCGUs
) (
    input  logic                   clk,
    input  logic                   rst,
    input  logic                   start_bounds,
    input  logic                   start_triangles,
    input  logic [31:0]            triangles,
    input  logic                   rd_valid,
    output logic                   rd_ready,
    input  logic [8*BUS_BYTES-1:0] rd_data,
    output logic                   group_valid,
    input  logic                   group_ready,
    output logic [1:0]             group_axis,
    output logic [32*INPUTS-1:0]   group_values,
    output logic [UNITS-1:0]       tri_valid,
    input  logic [UNITS-1:0]       tri_ready,
    output logic [31:0]            tri_id,
    output logic [287:0]           tri_coords,
    output logic                   bad,       // a coordinate was not finite
    output logic [31:0]            bad_word,  // which one, nine a triangle
    output logic                   done,
    output logic [3:0]             activity
);
  localparam int Words = BUS_BYTES / 4;
  localparam int WordBits = $clog2(Words);
  localparam int Ring = 3 * INPUTS;       // words
  localparam int Places = Ring / Words;   // beats
  localparam int Third = Places / 3;
  localparam int PlaceBits = $clog2(Places);
  localparam int HeldBits = $clog2(Ring + 1);
  localparam int CornerBits = $clog2(INPUTS);
  localparam logic [3:0] StalledBus = ft_pkg::Stalled + 4'd0;
  localparam logic [3:0] StalledUnits = ft_pkg::Stalled + 4'd1;

  logic bounds;                      // step 1
  logic [31:WordBits] left;          // whole beats of the stream
  logic [WordBits-1:0] left_words;   // and what is in a part of a beat behind them
  logic [31:0] count;                // beats of bounds up to the first bad one; triangles sent
  logic [PlaceBits-1:0] place;       // of the next beat in the ring
  logic [32*Ring-1:0] ring;
  logic [Ring-1:3] filled;           // places written since the start; the first ones always are
  logic any_left;
  logic take, last;                  // a beat; it is the last one
  logic [Words-1:0] there;           // words of it that belong to the stream
  logic [Words-1:0] not_finite;
  logic [WordBits-1:0] bad_lane;

  assign take = rd_valid && rd_ready;
  assign any_left = left != '0 || left_words != '0;
  assign last     = left == '0 || (left == (32 - WordBits)'(1) && left_words == '0);
  assign there    = left != '0 ? '1 : ~({Words{1'b1}} << left_words);
  for (genvar j = 0; j < Words; j++) begin : g_word
    assign not_finite[j] = there[j] && rd_data[32*j+23+:8] == 8'hff;
  end
  for (genvar w = 0; w < Ring; w++) begin : g_ring
    logic write;
    assign write = take && place == PlaceBits'(w / Words) && there[w%Words];
    always_ff @(posedge clk) begin
      if (write) ring[32*w+:32] <= rd_data[32*(w%Words)+:32];
    end
    if (w >= 3) begin : g_filled
      always_ff @(posedge clk) begin
        if (start_bounds) filled[w] <= 1'b0;
        else if (write) filled[w] <= 1'b1;
      end
    end
  end

  // Step 1. An axis is sent once in a ring of beats, a third of the ring behind the axis before it,
  // and all at the end. Values that have been sent already may be among them: to a bound that is
  // nothing. Places that have nothing yet repeat the first one.
  logic [2:0] pending;               // axes to send
  logic group_take;
  logic [31:0] first_value;

  assign group_valid = pending != '0 && !bad;
  assign group_take  = group_valid && group_ready;
  assign group_axis  = pending[0] ? 2'd0 : pending[1] ? 2'd1 : 2'd2;
  assign first_value = pending[0] ? ring[31:0] : pending[1] ? ring[63:32] : ring[95:64];
  assign group_values[31:0] = first_value;
  for (genvar i = 1; i < INPUTS; i++) begin : g_group
    logic [1:0] from;
    assign from = pending[0] ? (filled[3*i] ? 2'd0 : 2'd3)
                : pending[1] ? (filled[3*i+1] ? 2'd1 : 2'd3)
                             : (filled[3*i+2] ? 2'd2 : 2'd3);
    for (genvar b = 0; b < 32; b++) begin : g_bit
      logic [3:0] choice;
      assign choice = {first_value[b], ring[96*i+64+b], ring[96*i+32+b], ring[96*i+b]};
      assign group_values[32*i+b] = choice[from];
    end
  end

  // Step 2. The corners from `corner` on.
  logic [HeldBits-1:0] held;         // words
  logic [CornerBits-1:0] corner;
  logic [UNITS-1:0] turn;            // whose the next triangle is
  logic [HeldBits-1:0] come;         // words
  logic tri_take;

  assign tri_valid = held >= HeldBits'(9) ? turn : '0;
  assign tri_take  = (tri_valid & tri_ready) != '0;
  assign tri_id    = count;
  assign come      = !take ? '0 : left != '0 ? HeldBits'(Words) : HeldBits'(left_words);
  for (genvar c = 0; c < 3; c++) begin : g_corner
    logic [CornerBits-1:0] from;
    assign from = corner + CornerBits'(c);
    for (genvar b = 0; b < 96; b++) begin : g_bit
      logic [INPUTS-1:0] choice;
      for (genvar i = 0; i < INPUTS; i++) begin : g_choice
        assign choice[i] = ring[96*i+b];
      end
      assign tri_coords[96*c+b] = choice[from];
    end
  end

  // A beat may overwrite what is sent in the same cycle. Once bad, all is read and nothing kept.
  assign rd_ready = any_left &&
      (bad || (bounds ? pending == '0 || group_ready : held <= HeldBits'(Ring - Words)));

  always_ff @(posedge clk) begin
    if (rst) begin
      bounds  <= 1'b0;
      {left, left_words} <= '0;
      pending <= '0;
      held    <= '0;
      bad     <= 1'b0;
    end else if (start_bounds || start_triangles) begin
      bounds  <= start_bounds;
      {left, left_words} <= (triangles << 3) + triangles;
      place   <= '0;
      pending <= '0;
      held    <= '0;
      corner  <= '0;
      turn    <= UNITS'(1);
      if (start_bounds) bad <= 1'b0;
      if (start_bounds || !bad) count <= '0;
    end else begin
      if (take) begin
        if (left != '0) left <= left - 1'b1;
        else left_words <= '0;
        place <= place == PlaceBits'(Places - 1) ? '0 : place + 1'b1;
      end
      if (bad) begin
        pending <= '0;
      end else if (bounds) begin
        if (take) begin
          pending[0] <= last || place == PlaceBits'(Places - 1);
          pending[1] <= last || place == PlaceBits'(Third - 1);
          pending[2] <= last || place == PlaceBits'(2 * Third - 1);
          if (not_finite != '0) bad <= 1'b1;
          else count <= count + 1'b1;
        end else if (group_take) begin
          pending <= pending & (pending - 1'b1);
        end
      end else begin
        held <= held + come - (tri_take ? HeldBits'(9) : '0);
        if (tri_take) begin
          corner <= corner + CornerBits'(3);
          count  <= count + 1'b1;
          turn   <= UNITS'({turn, turn} >> (UNITS - 1));
        end
      end
    end
    // The first of them in the beat that `count` has stopped at.
    if (take && !bad) begin
      for (int j = Words - 1; j >= 0; j--) begin
        if (not_finite[j]) bad_lane <= WordBits'(j);
      end
    end
  end

  assign bad_word = {count[31-WordBits:0], bad_lane};

  assign done = !any_left && pending == '0 && held == '0;
  always_comb begin
    if (take || group_take || tri_take) activity = ft_pkg::Busy;
    else if (group_valid || tri_valid != '0) activity = StalledUnits;
    else if (!done) activity = StalledBus;
    else activity = ft_pkg::Idle;
  end

`ifndef SYNTHESIS
  initial begin
    assert (Words <= INPUTS && INPUTS >= 4 && (INPUTS & (INPUTS - 1)) == 0)
    else $error("ft_scene_reader: the bus is wider than a group, or a group is no power of two");
  end
  always_ff @(posedge clk) begin
    if (!rst) begin
      assert (!((start_bounds || start_triangles) && !done))
      else $error("ft_scene_reader: started while at work");
      assert (!(start_bounds && start_triangles)) else $error("ft_scene_reader: two starts at once");
      assert (held <= HeldBits'(Ring)) else $error("ft_scene_reader: more words than the ring has");
      assert ((turn & (turn - 1'b1)) == '0 || done) else $error("ft_scene_reader: two turns");
      assert (!(take && pending != '0 && !group_take && !bad))
      else $error("ft_scene_reader: a beat overwrites a group");
    end
  end
`endif
endmodule
