// SPDX-License-Identifier: Apache-2.0
// Step 4: of the sorted codes, each that differs from the one below it begins a leaf. WIDTH codes are
// compared at once; their leaves go into the buffer pool one a cycle, while the next codes are
// loaded, and leave it as rows of the leaf table when the base of the next leaf is known.
module ft_leaf_node #(
    parameter int BUS_BYTES = 16,
    parameter int WIDTH = 32,  // a power of two
    parameter int POOL = 64,
    parameter int BLOCK = 64
) (
    input  logic                   clk,
    input  logic                   rst,
    input  logic                   start,
    input  logic [31:0]            references,
    input  logic [31:0]            leaf_codes,     // where the leaves' codes go
    input  logic [31:0]            leaf_rows,      // where the rows go
    input  logic [31:0]            leaf_capacity,  // leaves that fit there
    input  logic                   rd_valid,
    output logic                   rd_ready,
    input  logic [8*BUS_BYTES-1:0] rd_data,
    output logic                   wr_code_valid,
    input  logic                   wr_code_ready,
    output logic [31:0]            wr_code_addr,
    output logic [6:0]             wr_code_bytes,
    output logic [8*BLOCK-1:0]     wr_code_data,
    output logic                   wr_row_valid,
    input  logic                   wr_row_ready,
    output logic [31:0]            wr_row_addr,
    output logic [6:0]             wr_row_bytes,
    output logic [8*BLOCK-1:0]     wr_row_data,
    output logic [31:0]            leaves,    // so far, those that fit
    output logic                   overflow,  // there are more leaves than fit; until the next start
    output logic                   done,
    output logic [3:0]             activity
);
  localparam int PerBeat = BUS_BYTES / 4;
  localparam int PlaceBits = $clog2(PerBeat);
  localparam int Beats = WIDTH / PerBeat;
  localparam int BeatBits = $clog2(Beats);
  localparam int IndexBits = $clog2(WIDTH);
  localparam int BlockBits = 32 - IndexBits;

  // Loading: WIDTH codes side by side for the comparators. `left` codes are still to come.
  logic [32*WIDTH-1:0] codes;
  logic [31:0]         left;
  logic [BeatBits-1:0] beat;
  logic [IndexBits:0]  loaded;
  logic [BlockBits-1:0] block;  // number of the block that is loaded
  logic                full, take, compare;
  logic [31:0]         taken;   // codes in the beat

  assign full     = loaded == (IndexBits+1)'(WIDTH) || (left == '0 && loaded != '0);
  assign rd_ready = left != '0 && (!full || compare);
  assign take     = rd_valid && rd_ready;
  assign taken    = left < 32'(PerBeat) ? left : 32'(PerBeat);

  always_ff @(posedge clk) begin
    for (int i = 0; i < Beats; i++) begin
      if (take && beat == BeatBits'(i)) codes[8*BUS_BYTES*i+:8*BUS_BYTES] <= rd_data;
    end
    if (rst) begin
      left   <= '0;
      loaded <= '0;
    end else if (start) begin
      left   <= references;
      loaded <= '0;
      beat   <= '0;
      block  <= '0;
    end else begin
      if (take) begin
        left <= left - taken;
        beat <= beat + 1'b1;
      end
      if (compare) block <= block + 1'b1;
      loaded <= (compare ? '0 : loaded) + (take ? (IndexBits+1)'(taken) : '0);
    end
  end

  // Comparing: the flags of all of them, each with its neighbour below.
  logic [WIDTH-1:0] differs, flags, lowest, rest;
  logic [31:0]      last_code;// the last code of the block before this one
  logic             moving;  // flags are left

  always_comb begin
    for (int i = 0; i < WIDTH; i++) begin
      differs[i] = (IndexBits+1)'(i) < loaded &&
                   (i == 0 ? block == '0 || codes[31:0] != last_code
                           : codes[32*i+:32] != codes[32*((i+WIDTH-1)%WIDTH)+:32]);
    end
  end

  // Moving on: the lowest flag of those left. The codes themselves are in a memory of four blocks:
  // the one that is loaded, the one whose flags are here, and the one before it, of which a leaf may
  // wait for the pool.
  logic                 pick, pool_ready, several;
  logic [BlockBits-1:0] flags_block;
  logic                 picked;
  logic [31:0]          picked_base;
  logic [IndexBits-1:0] place;
  logic [31:0]          picked_code;

  assign lowest  = flags & (~flags + 1'b1);
  assign rest    = flags & ~lowest;
  assign moving  = flags != '0;
  assign pick    = moving && (!picked || pool_ready);
  assign compare = full && (!moving || (pick && !several));

  // More than one flag is left: two of them differ in some bit of their index. `rest` comes too late
  // out of its carry to say so.
  logic at_zero, at_one;
  always_comb begin
    several = 1'b0;
    for (int bit_index = 0; bit_index < IndexBits; bit_index++) begin
      at_zero = 1'b0;
      at_one  = 1'b0;
      for (int i = 0; i < WIDTH; i++) begin
        if (((i >> bit_index) & 1) == 0) at_zero = at_zero | flags[i];
        else at_one = at_one | flags[i];
      end
      several = several | (at_zero & at_one);
    end
  end

  always_comb begin
    place = '0;
    for (int i = 0; i < WIDTH; i++) begin
      if (lowest[i]) place = place | IndexBits'(i);
    end
  end

  always_ff @(posedge clk) begin
    if (compare) begin
      last_code   <= codes[32*WIDTH-1-:32];
      flags_block <= block;
    end
    if (pick) picked_base <= {flags_block, place};
    if (rst || start) begin
      flags  <= '0;
      picked <= 1'b0;
    end else begin
      if (compare) flags <= differs;
      else if (pick) flags <= rest;
      if (pick) picked <= 1'b1;
      else if (pool_ready) picked <= 1'b0;
    end
  end

  logic [8*BUS_BYTES-1:0] memory[0:4*Beats-1];
  logic [8*BUS_BYTES-1:0] picked_beat;
  logic [1:0]             slot;
  assign slot        = 2'(block) + 2'(compare);
  assign picked_beat = memory[picked_base[IndexBits+1:PlaceBits]];
  assign picked_code = picked_beat[32*32'(picked_base[PlaceBits-1:0])+:32];
  always_ff @(posedge clk) begin
    if (take) memory[{slot, beat}] <= rd_data;
  end

  logic [$clog2(POOL+1)-1:0] pooled;
  logic                      pool_valid, pop;
  logic [31:0]               pool_code, pool_base;
  ft_fifo #(.WIDTH(64), .DEPTH(POOL)) pool (
      .clk, .rst,
      .in_valid(picked), .in_ready(pool_ready), .in_data({picked_code, picked_base}),
      .out_valid(pool_valid), .out_ready(pop), .out_data({pool_code, pool_base}), .count(pooled)
  );

  // Rows: a leaf ends where the next one begins, and the last one where the references end.
  logic        all_pooled, open, row_valid, row_ready, close;
  logic [31:0] open_code, open_base;
  logic [31:0] row_code, row_first, row_count;

  assign all_pooled = left == '0 && loaded == '0 && !moving && !picked && pooled == '0;
  assign close      = open && (pool_valid || all_pooled) && (!row_valid || row_ready);
  assign pop        = !open || !row_valid || row_ready;

  always_ff @(posedge clk) begin
    if (pool_valid && pop) begin
      open_code <= pool_code;
      open_base <= pool_base;
    end
    if (close) begin
      row_code  <= open_code;
      row_first <= open_base;
      row_count <= (pool_valid ? pool_base : references) - open_base;
    end
    if (rst) begin
      open      <= 1'b0;
      row_valid <= 1'b0;
    end else if (start) begin
      open      <= 1'b0;
      row_valid <= references == '0;
    end else begin
      open      <= (pool_valid && pop) || (open && !close);
      row_valid <= close || (row_valid && !row_ready);
    end
    // No references: one row without any.
    if (start) begin
      row_first <= '0;
      row_count <= '0;
    end
  end

  // To memory: the code and the row together, while there is room in the table.
  logic [31:0] room;  // leaves that still fit
  logic fits, empty, code_ready, table_ready, put, flush, code_holds, row_holds;
  assign empty     = references == '0;
  assign row_ready = !fits || (code_ready && table_ready);
  assign put       = row_valid && row_ready && fits;
  assign flush     = all_pooled && !open && !row_valid;
  assign done      = flush && !code_holds && !row_holds;

  always_ff @(posedge clk) begin
    if (rst || start) begin
      leaves   <= '0;
      overflow <= 1'b0;
      room     <= leaf_capacity;
      fits     <= leaf_capacity != '0;
    end else begin
      if (put && !empty) begin
        leaves <= leaves + 1'b1;
        room   <= room - 1'b1;
        fits   <= room[31:1] != '0;
      end
      if (row_valid && !fits) overflow <= 1'b1;
    end
  end

  ft_block_writer #(.BLOCK(BLOCK), .ITEM(4)) code_writer (
      .clk,
      .start(start || rst), .addr(leaf_codes),
      .put_valid(put && !empty), .put_ready(code_ready), .put_data(row_code),
      .flush, .holds(code_holds),
      .wr_valid(wr_code_valid), .wr_ready(wr_code_ready), .wr_addr(wr_code_addr),
      .wr_bytes(wr_code_bytes), .wr_data(wr_code_data)
  );
  ft_block_writer #(.BLOCK(BLOCK), .ITEM(8)) row_writer (
      .clk,
      .start(start || rst), .addr(leaf_rows),
      .put_valid(put), .put_ready(table_ready), .put_data({row_count, row_first}),
      .flush, .holds(row_holds),
      .wr_valid(wr_row_valid), .wr_ready(wr_row_ready), .wr_addr(wr_row_addr),
      .wr_bytes(wr_row_bytes), .wr_data(wr_row_data)
  );

  logic worked;
  assign worked = take || compare || pick || (pool_valid && pop) || (row_valid && row_ready) || close ||
                  (wr_code_valid && wr_code_ready) || (wr_row_valid && wr_row_ready);
  always_comb begin
    if (done) activity = ft_pkg::Idle;
    else if (worked) activity = ft_pkg::Busy;
    else if (row_valid || flush) activity = ft_pkg::Stalled + 4'd1;  // the bus, writing
    else activity = ft_pkg::Stalled;                                 // the bus, reading
  end

`ifndef SYNTHESIS
  always_ff @(posedge clk) begin
    if (!rst) begin
      assert (!start || done) else $error("ft_leaf_node: started while at work");
      assert (!close || all_pooled || pool_base > open_base)
      else $error("ft_leaf_node: a leaf without references");
    end
  end
`endif
endmodule
