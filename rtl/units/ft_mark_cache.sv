// SPDX-License-Identifier: Apache-2.0
// The on-chip cache between BEU and PCU: set associative, least recently used, write back, blocks of
// 8 bytes, one request at a time. A hit is answered in the cycle in which it is at the head of the
// queue: the rows of its set are read while it enters. Docs: docs/accelerator/mark_cache.md.
module ft_mark_cache #(
    parameter int BYTES = 16384,
    parameter int WAYS = 16,        // a power of two, at least 2
    parameter int MISS_PENALTY = 2  // cycles before a miss asks for its block, at least 2
) (
    input  logic        clk,
    input  logic        rst,
    input  logic        clear,  // forget everything, a set a cycle, as after `rst`; only while done
    input  logic        flush,  // write back what memory does not have; only while done
    input  logic        req_valid,
    output logic        req_ready,
    input  logic [31:0] req_addr,
    input  logic        req_write,
    input  logic [31:0] req_word,
    output logic        ans_valid,
    input  logic        ans_ready,
    output logic [31:0] ans_word,
    output logic        wr_valid,
    input  logic        wr_ready,
    output logic [31:0] wr_addr,
    output logic [6:0]  wr_bytes,
    output logic [63:0] wr_data,
    output logic        rdq_valid,
    input  logic        rdq_ready,
    output logic [31:0] rdq_addr,
    input  logic        rdd_valid,
    output logic        rdd_ready,
    input  logic [63:0] rdd_data,
    output logic [31:0] reads,
    output logic [31:0] read_hits,
    output logic [31:0] writes,
    output logic [31:0] write_hits,
    output logic [31:0] write_backs,
    output logic        done,
    output logic [3:0]  activity  // stalled on: the bus, path_compression
);
  localparam int Sets = BYTES / (8 * WAYS);
  localparam int SetBits = $clog2(Sets);
  localparam int TagBits = 29 - SetBits;
  localparam int Pairs = WAYS * (WAYS - 1) / 2;
  localparam int WaitBits = $clog2(MISS_PENALTY);
  localparam logic [WAYS-1:0] OddWays = {(WAYS / 2) {2'b10}};

  typedef enum logic [3:0] {
    Clear,
    Ready,
    Answer,  // a hit that waits for room
    Miss,
    Issue,   // hands on the write-back and the read
    Fill,
    FlushPick,
    FlushRead,
    FlushWrite
  } state_t;
  state_t state;

  // The queue of requests: the head, and the one behind it.
  logic [31:2] head_addr, tail_addr, next_addr;
  logic head_write, tail_write, next_write;
  logic [31:0] head_word, tail_word, next_word;
  logic [1:0] count;
  logic push, look;

  // The request looked up last; in a flush and a clear the set at hand.
  logic [31:2] held_addr;
  logic held_write;
  logic [31:0] held_word;
  logic [WAYS-1:0] way;  // its own, as one bit: the hit, or the victim
  logic looked, missed;  // looked up in the cycle before; without success

  logic [SetBits-1:0] head_set, held_set;
  logic [TagBits-1:0] head_tag;
  assign head_set = head_addr[3+:SetBits];
  assign held_set = held_addr[3+:SetBits];
  assign head_tag = head_addr[31-:TagBits];

  assign req_ready = count != 2'd2;
  assign push      = req_valid && req_ready;
  assign look      = state == Ready && count != 2'd0;

  always_comb begin
    next_addr  = req_addr[31:2];
    next_write = req_write;
    next_word  = req_word;
    if (look && count == 2'd2) begin
      next_addr  = tail_addr;
      next_write = tail_write;
      next_word  = tail_word;
    end else if (!look && count != 2'd0) begin
      next_addr  = head_addr;
      next_write = head_write;
      next_word  = head_word;
    end
  end

  always_ff @(posedge clk) begin
    head_addr  <= next_addr;
    head_write <= next_write;
    head_word  <= next_word;
    if (push) begin
      tail_addr  <= req_addr[31:2];
      tail_write <= req_write;
      tail_word  <= req_word;
    end
    if (rst) count <= 2'd0;
    else count <= count + 2'(push) - 2'(look);
  end

  // Tags and data. Word b of way w lies in bank w ^ b, so that a look-up reads this word of all ways
  // with 16 banks of one word, and still both words of one way can be read or written at once. Each
  // word has its block's tag beside it, in the half of a block RAM that would lie idle: a bank's
  // comparison picks its word, without a choice between two ways.
  logic aside, read_odd, way_odd, fill;
  logic [SetBits-1:0] read_set, write_set;
  logic read_word_even, read_word_odd, write_word_even, write_word_odd;
  logic [31:0] write_data_even, write_data_odd;
  logic [63:0] filled_block;
  logic [TagBits*WAYS-1:0] tag_row;
  logic [32*WAYS-1:0] bank_row;
  logic [WAYS-1:0] bank_write, oldest;

  assign aside = state == Miss || state == Issue || state == FlushRead || state == FlushWrite;
  assign way_odd         = (way & OddWays) != '0;
  assign read_odd        = missed ? (oldest & OddWays) != '0 : way_odd;
  assign read_set        = aside ? held_set : next_addr[3+:SetBits];
  assign read_word_even  = aside ? read_odd : next_addr[2];
  assign read_word_odd   = aside ? !read_odd : next_addr[2];
  assign write_set       = fill ? held_set : head_set;
  assign write_word_even = fill ? way_odd : head_addr[2];
  assign write_word_odd  = fill ? !way_odd : head_addr[2];
  assign write_data_even = fill ? (way_odd ? filled_block[63:32] : filled_block[31:0]) : head_word;
  assign write_data_odd  = fill ? (way_odd ? filled_block[31:0] : filled_block[63:32]) : head_word;

  for (genvar w = 0; w < WAYS; w = w + 1) begin : gen_way
    logic [SetBits:0] from, to;
    assign from = {read_set, w % 2 == 0 ? read_word_even : read_word_odd};
    assign to   = {write_set, w % 2 == 0 ? write_word_even : write_word_odd};

    logic [TagBits-1:0] tags[0:2*Sets-1];
    logic [TagBits-1:0] tag;
    always_ff @(posedge clk) begin
      if (fill && (way[w] || way[w^1])) tags[to] <= held_addr[31-:TagBits];
      tag <= tags[from];
    end
    assign tag_row[TagBits*w+:TagBits] = tag;

    logic [31:0] words[0:2*Sets-1];
    logic [31:0] word;
    always_ff @(posedge clk) begin
      if (bank_write[w]) words[to] <= w % 2 == 0 ? write_data_even : write_data_odd;
      word <= words[from];
    end
    assign bank_row[32*w+:32] = word;
  end

  // What is known of a set, beside its tags. All zeros: nothing valid, way 0 to be filled first.
  // Block RAM would be slow here: `oldest` leads to the address of another one.
  (* ram_style = "distributed" *) logic [WAYS-1:0] valid_rows[0:Sets-1];
  (* ram_style = "distributed" *) logic [WAYS-1:0] dirty_rows[0:Sets-1];
  (* ram_style = "distributed" *) logic [Pairs-1:0] order_rows[0:Sets-1];
  logic [WAYS-1:0] head_valid, held_valid, dirty, dirty_next;
  logic [Pairs-1:0] order, order_next;
  logic clearing, dirty_drop, dirty_put;

  assign head_valid   = valid_rows[head_set];
  assign clearing     = state == Clear;
  assign dirty        = dirty_rows[held_set];
  assign order        = order_rows[held_set];
  assign dirty_drop   = fill || state == FlushWrite;
  assign dirty_put    = held_write && (fill || (looked && !missed));
  assign dirty_next   = (dirty & ~(way & {WAYS{dirty_drop}})) | (way & {WAYS{dirty_put}});

  ft_lru #(.WAYS(WAYS)) lru (
      .order  (order),
      .used   (missed ? oldest : way),
      .updated(order_next),
      .oldest (oldest)
  );

  always_ff @(posedge clk) begin
    if (clearing || fill) valid_rows[held_set] <= clearing ? '0 : held_valid | way;
    if (clearing || looked) order_rows[held_set] <= clearing ? '0 : order_next;
    if (clearing || looked || fill || (state == FlushWrite && wr_ready)) begin
      dirty_rows[held_set] <= clearing ? '0 : dirty_next;
    end
  end

  // The look-up. What was written in the cycle before has not been read: the rows were read then. A
  // word written by a hit is found by its tag, but is not what was read; a block filled is not found.
  logic wrote, filled;  // in the cycle before: a word, by a hit; a block
  logic [63:0] last_block;
  logic same_set, same_block, written_word, filled_again, hit;
  logic [WAYS-1:0] live, finds, hits, victims, picks, stores;  // finds: by bank
  logic [31:0] even_word, odd_word, other_word, late_word, found_word;
  logic [TagBits-1:0] victim_tag;

  assign same_set     = head_set == held_set;
  assign same_block   = head_addr[31:3] == held_addr[31:3];
  assign written_word = same_block && wrote && head_addr[2] == held_addr[2];
  assign filled_again = same_block && filled;
  assign live = head_valid & ~(way & {WAYS{filled && same_set}}) & {WAYS{state == Ready}};
  assign hit  = filled_again || finds != '0;

  for (genvar w = 0; w < WAYS; w = w + 1) begin : gen_hit
    assign finds[w] = live[head_addr[2]?w^1 : w] && tag_row[TagBits*w+:TagBits] == head_tag;
    assign hits[w]  = finds[head_addr[2]?w^1 : w];
    // Selected by the late `finds` with as little as possible behind them.
    assign victims[w] = (state == Issue || state == FlushWrite) && (way[w] || way[w^1]);
    assign picks[w]   = victims[w] || (!written_word && finds[w]);
    assign stores[w]  = fill ? way[w] || way[w^1]
                             : look && head_write && filled_again && way[head_addr[2] ? w ^ 1 : w];
    assign bank_write[w] = stores[w] || (look && head_write && finds[w]);
  end

  always_comb begin
    even_word  = '0;
    odd_word   = '0;
    victim_tag = '0;
    for (int w = 0; w < WAYS; w += 2) begin
      even_word |= bank_row[32*w+:32] & {32{picks[w]}};
      odd_word |= bank_row[32*w+32+:32] & {32{picks[w+1]}};
    end
    for (int w = 0; w < WAYS; w = w + 1) begin
      victim_tag |= tag_row[TagBits*w+:TagBits] & {TagBits{way[w]}};
    end
    case (state)
      Ready:   other_word = written_word ? held_word :
                            !filled_again ? '0 :
                            head_addr[2] ? last_block[63:32] : last_block[31:0];
      Answer:  other_word = late_word;
      default: other_word = held_addr[2] ? rdd_data[63:32] : rdd_data[31:0];
    endcase
    found_word = even_word | odd_word | other_word;
    filled_block = rdd_data;
    if (held_write && held_addr[2]) filled_block[63:32] = held_word;
    if (held_write && !held_addr[2]) filled_block[31:0] = held_word;
  end

  // The answers.
  logic answer_room, answer;
  logic [1:0] answers;
  assign answer = (look && hit && !head_write) || state == Answer || (fill && !held_write);

  ft_fifo #(.WIDTH(32), .DEPTH(2)) answer_queue (
      .clk      (clk),
      .rst      (rst),
      .in_valid (answer),
      .in_ready (answer_room),
      .in_data  (found_word),
      .out_valid(ans_valid),
      .out_ready(ans_ready),
      .out_data (ans_word),
      .count    (answers)
  );

  // Memory.
  logic must_write, asked;
  logic [WaitBits-1:0] left;  // cycles of `Miss`

  assign wr_valid  = (state == Issue && must_write) || state == FlushWrite;
  assign wr_addr   = {victim_tag, held_set, 3'b000};
  assign wr_bytes  = 7'd8;
  assign wr_data   = way_odd ? {even_word, odd_word} : {odd_word, even_word};
  assign rdq_valid = state == Issue && !asked;
  assign rdq_addr  = {held_addr[31:3], 3'b000};
  assign rdd_ready = state == Fill && (held_write || answer_room);
  assign fill      = rdd_valid && rdd_ready;

  always_ff @(posedge clk) begin
    looked <= look && !rst;
    missed <= look && !hit && !rst;
    wrote  <= look && hit && head_write && !rst;
    filled <= fill && !rst;
    if (fill) last_block <= filled_block;
    if (look) begin
      held_addr  <= head_addr;
      held_write <= head_write;
      held_word  <= head_word;
      held_valid <= head_valid;
      late_word  <= found_word;
      left       <= WaitBits'(MISS_PENALTY - 2);
      asked      <= 1'b0;
    end
    if (look && !filled_again) way <= hits;
    if (missed) begin
      way        <= oldest;
      must_write <= (dirty & oldest) != '0;
    end

    case (state)
      Clear: begin
        held_addr[3+:SetBits] <= held_set + 1'b1;
        if (&held_set) state <= Ready;
      end
      Ready: begin
        if (look && !hit) state <= Miss;
        else if (look && !head_write && !answer_room) state <= Answer;
        if (flush) state <= FlushPick;
        if (flush || clear) held_addr[3+:SetBits] <= '0;
      end
      Answer: if (answer_room) state <= Ready;
      Miss: begin
        left <= left - 1'b1;
        if (left == '0) state <= Issue;
      end
      Issue: begin
        if (wr_ready) must_write <= 1'b0;
        if (rdq_ready) asked <= 1'b1;
        if ((wr_ready || !must_write) && (rdq_ready || asked)) state <= Fill;
      end
      Fill: if (fill) state <= Ready;
      FlushPick: begin
        way <= dirty & (~dirty + 1'b1);
        if (dirty != '0) state <= FlushRead;
        else begin
          held_addr[3+:SetBits] <= held_set + 1'b1;
          if (&held_set) state <= Ready;
        end
      end
      FlushRead: state <= FlushWrite;
      FlushWrite: if (wr_ready) state <= FlushPick;
      default: ;
    endcase
    if (rst) held_addr[3+:SetBits] <= '0;
    if (rst || clear) state <= Clear;
  end

  // Counted in the cycle after the look-up.
  always_ff @(posedge clk) begin
    if (rst || clear) begin
      reads       <= '0;
      read_hits   <= '0;
      writes      <= '0;
      write_hits  <= '0;
      write_backs <= '0;
    end else begin
      if (looked && !held_write) reads <= reads + 1'b1;
      if (looked && !held_write && !missed) read_hits <= read_hits + 1'b1;
      if (looked && held_write) writes <= writes + 1'b1;
      if (looked && held_write && !missed) write_hits <= write_hits + 1'b1;
      if (state == Issue && must_write && wr_ready) write_backs <= write_backs + 1'b1;
    end
  end

  assign done = state == Ready && count == 2'd0 && answers == 2'd0;

  always_comb begin
    activity = ft_pkg::Busy;
    case (state)
      Ready: begin
        if (!look) activity = ft_pkg::Idle;
        else if (hit && !head_write && !answer_room) activity = ft_pkg::Stalled + 4'd1;
      end
      Answer: if (!answer_room) activity = ft_pkg::Stalled + 4'd1;
      Issue, FlushWrite: activity = ft_pkg::Stalled;
      Fill: begin
        if (!rdd_valid) activity = ft_pkg::Stalled;
        else if (!rdd_ready) activity = ft_pkg::Stalled + 4'd1;
      end
      default: activity = ft_pkg::Busy;
    endcase
  end

`ifndef SYNTHESIS
  always_ff @(posedge clk) begin
    if (!rst) begin
      assert (!look || (hits & (hits - 1'b1)) == '0) else $error("ft_mark_cache: a block in two ways");
      assert (!((clear || flush) && !done)) else $error("ft_mark_cache: cleared at work");
      assert (!req_valid || req_addr[1:0] == 2'b00) else $error("ft_mark_cache: part of a word");
      assert (!missed || (oldest != '0 && (oldest & (oldest - 1'b1)) == '0))
      else $error("ft_mark_cache: no order of use");
      assert (!rdd_valid || state == Fill || (state == Issue && asked))
      else $error("ft_mark_cache: data that was not asked for");
    end
  end
`endif
endmodule
