// SPDX-License-Identifier: Apache-2.0
// What a scatter writes to: gathers pairs for a place into a block a digit and hands on full blocks.
// Two pairs come a cycle, a block goes a cycle. Places of a digit come in order, without gaps.
//
// A digit has two blocks, so that one can fill while the other waits. In rounds before the last an
// item is a pair of 8 bytes; in the last one codes and ids have blocks of their own, of words, which
// are full together. The two pairs of a cycle go to memories of their own (a LUT RAM has one port to
// write), and a bit a place says which one has it.
module ft_digit_blocks #(
    parameter int RADIX_BITS = 4,
    parameter int COMBINE = 32  // bytes of a block, 16 to 64
) (
    input  logic                    clk,
    input  logic                    rst,
    input  logic                    start,        // of a round; what follows is stable until its end
    input  logic                    last,
    input  logic [31:0]             to,           // multiples of COMBINE
    input  logic [31:0]             to_ids,
    input  logic                    begin_valid,  // where a digit begins, before its first pair
    input  logic [RADIX_BITS-1:0]   begin_digit,
    input  logic [31:0]             begin_place,
    input  logic [1:0]              in_valid,     // not the second alone
    output logic                    in_ready,     // for both; depends on what they are
    input  logic [2*RADIX_BITS-1:0] in_digits,
    input  logic [63:0]             in_places,
    input  logic [63:0]             in_codes,
    input  logic [63:0]             in_ids,
    input  logic                    flush_valid,  // of a digit that ends before this place; when empty at first
    output logic                    flush_ready,
    input  logic [RADIX_BITS-1:0]   flush_digit,
    input  logic [31:0]             flush_place,
    output logic                    empty,        // no full block waits, nor a request
    output logic                    wr_valid,
    input  logic                    wr_ready,
    output logic [31:0]             wr_addr,
    output logic [6:0]              wr_bytes,
    output logic [8*COMBINE-1:0]    wr_data
);
  localparam int Radix = 1 << RADIX_BITS;
  localparam int Words = COMBINE / 4;
  localparam int WordBits = $clog2(Words);
  localparam int BlockBits = 32 - $clog2(COMBINE);
  localparam int RowBits = RADIX_BITS + 1;
  localparam int EventBits = RADIX_BITS + BlockBits + WordBits;

  if (COMBINE < 16 || COMBINE > 64) begin : gen_combine
    $error("COMBINE is 16, 32 or 64");
  end

  // A block that goes: its digit, its number, and the item behind its last one; 0 where it is full.
  logic [EventBits-1:0] event0, event1, event_flush, first_event, ev;
  logic ev_valid, take, accept;

  // ---- What comes: which row and place of it, and what it completes.
  logic [1:0] complete;
  logic [2*RowBits-1:0] rows;
  logic [2*WordBits-1:0] slots;  // in words where last, else in pairs
  logic [2*BlockBits-1:0] blocks;
  logic [2*Radix-1:0] pending;  // rows that are full and have to be read yet

  for (genvar k = 0; k < 2; k++) begin : gen_lane
    logic [31:0] place;
    assign place = in_places[32*k+:32];
    assign slots[WordBits*k+:WordBits] = {last && place[WordBits-1], place[WordBits-2:0]};
    assign blocks[BlockBits*k+:BlockBits] =
        last ? place[WordBits+:BlockBits] : place[WordBits-1+:BlockBits];
    assign rows[RowBits*k+:RowBits] = {blocks[BlockBits*k], in_digits[RADIX_BITS*k+:RADIX_BITS]};
    assign complete[k] = in_valid[k] && &place[WordBits-2:0] && (!last || place[WordBits-1]);
  end
  assign event0 = {in_digits[0+:RADIX_BITS], blocks[0+:BlockBits], WordBits'(0)};
  assign event1 = {in_digits[RADIX_BITS+:RADIX_BITS], blocks[BlockBits+:BlockBits], WordBits'(0)};

  // ---- Full blocks wait in two queues that take turns, since two may come in a cycle.
  logic [1:0] bank_ready, bank_valid, push, pop;
  logic [3:0] waiting;  // 2 a bank
  logic [2*EventBits-1:0] bank_in, bank_out;
  logic tail, head;  // the bank whose turn it is
  logic room, flush_holds, one, two;

  assign room     = &bank_ready;
  assign in_ready = room && !(in_valid[0] && pending[rows[0+:RowBits]])
                         && !(in_valid[1] && pending[rows[RowBits+:RowBits]]);
  assign accept   = in_valid[0] && in_ready;
  assign flush_ready = room;
  assign one = (accept && |complete) || (flush_valid && room && flush_holds);
  assign two = accept && &complete;
  assign first_event = flush_valid ? event_flush : complete[0] ? event0 : event1;

  for (genvar b = 0; b < 2; b++) begin : gen_bank
    assign push[b] = tail == 1'(b) ? one : two;
    assign bank_in[EventBits*b+:EventBits] = tail == 1'(b) ? first_event : event1;
    assign pop[b] = take && head == 1'(b);
    ft_fifo #(
        .WIDTH(EventBits), .DEPTH(2)
    ) u_queue (
        .clk(clk), .rst(rst),
        .in_valid(push[b]), .in_ready(bank_ready[b]), .in_data(bank_in[EventBits*b+:EventBits]),
        .out_valid(bank_valid[b]), .out_ready(pop[b]), .out_data(bank_out[EventBits*b+:EventBits]),
        .count(waiting[2*b+:2])
    );
  end
  assign ev       = head ? bank_out[EventBits+:EventBits] : bank_out[0+:EventBits];
  assign ev_valid = bank_valid[head];

  // ---- A digit's first block begins where the digit does.
  logic [WordBits-1:0] begin_slots[0:Radix-1];
  logic [Radix-1:0] fresh;  // no block of the digit has gone yet
  logic [WordBits-1:0] ev_first, flush_first, flush_end, ev_end;
  logic [RADIX_BITS-1:0] ev_digit;
  logic [BlockBits-1:0] ev_block, flush_block;

  assign {ev_digit, ev_block, ev_end} = ev;
  assign ev_first    = fresh[ev_digit] ? begin_slots[ev_digit] : '0;
  assign flush_first = fresh[flush_digit] ? begin_slots[flush_digit] : '0;
  assign flush_end   = {last && flush_place[WordBits-1], flush_place[WordBits-2:0]};
  assign flush_block = last ? flush_place[WordBits+:BlockBits] : flush_place[WordBits-1+:BlockBits];
  assign flush_holds = flush_end != flush_first;
  assign event_flush = {flush_digit, flush_block, flush_end};

  // ---- The blocks. In words of a row: pairs (code, id) or codes in `main`, ids in `ids`.
  logic [RowBits-1:0] ev_row;
  logic [8*COMBINE-1:0] image;
  logic second;  // the ids of a block whose codes have gone

  assign ev_row = {ev_block[0], ev_digit};

  for (genvar w = 0; w < Words; w++) begin : gen_word
    logic [31:0] main0[0:2*Radix-1], main1[0:2*Radix-1], ids0[0:2*Radix-1], ids1[0:2*Radix-1];
    // Which of the two memories has the word: their exclusive or. Each is written by one lane only.
    logic lane0[0:2*Radix-1], lane1[0:2*Radix-1];
    logic [1:0] write;
    logic [63:0] data;
    logic lane;

    for (genvar k = 0; k < 2; k++) begin : gen_write
      assign write[k] = in_ready && in_valid[k] &&
                        slots[WordBits*k+:WordBits] == (last ? WordBits'(w) : WordBits'(w / 2));
      assign data[32*k+:32] = w % 2 == 0 || last ? in_codes[32*k+:32] : in_ids[32*k+:32];
    end

    always_ff @(posedge clk) begin
      if (write[0]) begin
        main0[rows[0+:RowBits]] <= data[0+:32];
        ids0[rows[0+:RowBits]]  <= in_ids[0+:32];
        lane0[rows[0+:RowBits]] <= lane1[rows[0+:RowBits]];
      end
      if (write[1]) begin
        main1[rows[RowBits+:RowBits]] <= data[32+:32];
        ids1[rows[RowBits+:RowBits]]  <= in_ids[32+:32];
        lane1[rows[RowBits+:RowBits]] <= !lane0[rows[RowBits+:RowBits]];
      end
    end

    assign lane = lane0[ev_row] ^ lane1[ev_row];
    assign image[32*w+:32] = second ? (lane ? ids1[ev_row] : ids0[ev_row])
                                    : (lane ? main1[ev_row] : main0[ev_row]);
  end

  // ---- To the port: a block, or its codes and then its ids, through a register.
  logic load;
  logic [BlockBits-1:0] base;
  logic [WordBits:0] items;
  logic [WordBits-1:0] offset;  // of the first one, in words

  assign load   = ev_valid && (!wr_valid || wr_ready);
  assign take   = load && (!last || second);
  assign base   = second ? to_ids[31-:BlockBits] : to[31-:BlockBits];
  assign items  = {last && ev_end == '0, !last && ev_end == '0 || ev_end[WordBits-1],
                   ev_end[WordBits-2:0]} - {1'b0, ev_first};
  assign offset = last ? ev_first : {ev_first[WordBits-2:0], 1'b0};
  assign empty  = bank_valid == '0 && !wr_valid;

  always_ff @(posedge clk) begin
    if (load) begin
      wr_addr  <= {base + ev_block, offset, 2'b0};
      wr_bytes <= 7'(items) << (last ? 2 : 3);
      wr_data  <= image;
    end
    if (begin_valid) begin
      begin_slots[begin_digit] <= {last && begin_place[WordBits-1], begin_place[WordBits-2:0]};
    end
    if (rst) begin
      wr_valid <= 1'b0;
      second   <= 1'b0;
      head     <= 1'b0;
      tail     <= 1'b0;
    end else begin
      if (load || wr_ready) wr_valid <= load;
      if (load && last) second <= !second;
      if (take) head <= !head;
      if (one && !two) tail <= !tail;
    end
  end

  for (genvar d = 0; d < Radix; d++) begin : gen_fresh
    always_ff @(posedge clk) begin
      if (start) fresh[d] <= 1'b1;
      else if (take && ev_digit == RADIX_BITS'(d)) fresh[d] <= 1'b0;
    end
  end
  for (genvar r = 0; r < 2 * Radix; r++) begin : gen_pending
    logic set, clear;
    assign set = accept && ((complete[0] && rows[0+:RowBits] == RowBits'(r))
                            || (complete[1] && rows[RowBits+:RowBits] == RowBits'(r)));
    assign clear = rst || (take && ev_row == RowBits'(r));
    always_ff @(posedge clk) begin
      if (set) pending[r] <= 1'b1;
      else if (clear) pending[r] <= 1'b0;
    end
  end

`ifndef SYNTHESIS
  always_ff @(posedge clk) begin
    if (!rst) begin
      assert (in_valid != 2'b10) else $error("ft_digit_blocks: the second pair without the first");
      assert (!(accept && in_valid[1]) || rows[0+:RowBits] != rows[RowBits+:RowBits]
              || slots[0+:WordBits] != slots[WordBits+:WordBits])
      else $error("ft_digit_blocks: two pairs to one place");
      assert (waiting[1:0] + {1'b0, tail ^ head} == waiting[3:2]
              || waiting[3:2] + {1'b0, tail ^ head} == waiting[1:0])
      else $error("ft_digit_blocks: the queues do not take turns");
      assert (!(flush_valid && |in_valid)) else $error("ft_digit_blocks: flushed while pairs come");
      assert (!start || ((to | to_ids) & 32'(COMBINE - 1)) == '0)
      else $error("ft_digit_blocks: an array is not aligned to blocks");
      assert (!start || empty) else $error("ft_digit_blocks: started before the last round's end");
    end
  end
`endif
endmodule
