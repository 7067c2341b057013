// SPDX-License-Identifier: Apache-2.0
// The writing half of the bus: the clients' ports, who is next, and the cutting of requests into
// beats. Three steps: a request's place is taken from its port; it is checked and its beats are
// fetched, one a cycle; a register holds the beat for the bus. Requests follow without a gap.
module ft_bus_writes #(
    parameter int BUS_BYTES = 16,
    parameter int WRITERS = 8,
    parameter int REQUEST_QUEUE = 4,
    parameter int WRITES_IN_FLIGHT = 64,
    parameter int ID_BITS = 4,
    parameter logic [7*WRITERS-1:0] BLOCKS = {
      7'd8, 7'd8, 7'd64, 7'd64, 7'd64, 7'd64, 7'd32, 7'd32
    },
    parameter logic [WRITERS-1:0] ZEROS = 8'b0010_0000,
    parameter int CACHE_WRITER = 6,
    parameter int ORDER_ENTRIES = 8
) (
    input  logic                     clk,
    input  logic                     rst,
    input  logic                     cancel,
    input  logic [31:6]              window_first,
    input  logic [31:6]              window_behind,
    input  logic [WRITERS-1:0]       wr_valid,
    output logic [WRITERS-1:0]       wr_ready,
    input  logic [32*WRITERS-1:0]    wr_addr,
    input  logic [7*WRITERS-1:0]     wr_bytes,
    input  logic [512*WRITERS-1:0]   wr_data,
    output logic                     idle,         // nothing queued, held, or not answered
    output logic                     stray,        // pulse: a request was dropped
    output logic [31:0]              stray_addr,
    input  logic [31:3]              order_addr,   // of a read of the cache
    output logic [ORDER_ENTRIES-1:0] order_match,  // its writes to there that are under way
    output logic [ORDER_ENTRIES-1:0] order_leave,
    output logic                     aw_valid,
    input  logic                     aw_ready,
    output logic [ID_BITS-1:0]       aw_id,
    output logic [31:0]              aw_addr,
    output logic [7:0]               aw_len,
    output logic                     w_load,       // a beat comes into the register
    output logic                     w_valid,
    input  logic                     w_take,
    output logic [8*BUS_BYTES-1:0]   w_data,
    output logic [BUS_BYTES-1:0]     w_strb,
    output logic                     w_last,
    input  logic                     b_valid,
    input  logic [ID_BITS-1:0]       b_id
);
  localparam int Words = BUS_BYTES / 4;
  localparam int WordBits = $clog2(Words);
  localparam int ClientBits = WRITERS > 1 ? $clog2(WRITERS) : 1;
  localparam int FlightBits = $clog2(WRITES_IN_FLIGHT + 1);

  // The request whose beats are being fetched.
  logic held, first;           // its first beat is still to come
  logic [ClientBits-1:0] client;
  logic [31:2] addr;
  logic [3:0] word;            // of the aligned 64 bytes: where the next beat begins
  logic [3:0] from;            // the same, in its beat
  logic [4:0] left;            // words from there on
  logic [5:0] past;            // words from the beginning of this beat to the request's end
  logic last, outside, drop, room, done, take_place;

  // ---- Ports.
  logic [WRITERS-1:0] port_ready, place_valid, place_grant, data_drop, empty;
  logic [30*WRITERS-1:0] place_addr;
  logic [5*WRITERS-1:0] place_words;
  logic [8*BUS_BYTES*WRITERS-1:0] beats;
  logic order_ready, order_settled;

  for (genvar c = 0; c < WRITERS; c++) begin : g_port
    localparam int Block = 32'(BLOCKS[7*c+:7]);
    assign wr_ready[c]  = port_ready[c] && (c != CACHE_WRITER || order_ready);
    assign data_drop[c] = done && 32'(client) == c;
    ft_write_port #(
        .BLOCK(Block),
        .BUS_BYTES(BUS_BYTES),
        .DEPTH(REQUEST_QUEUE),
        .ZEROS(ZEROS[c])
    ) u_port (
        .clk(clk),
        .rst(rst),
        .wr_valid(wr_valid[c] && (c != CACHE_WRITER || order_ready)),
        .wr_ready(port_ready[c]),
        .wr_addr(wr_addr[32*c+:32]),
        .wr_bytes(wr_bytes[7*c+:7]),
        .wr_data(wr_data[512*c+:8*Block]),
        .place_valid(place_valid[c]),
        .place_take(take_place && place_grant[c]),
        .place_addr(place_addr[30*c+:30]),
        .place_words(place_words[5*c+:5]),
        .word(word),
        .beat(beats[8*BUS_BYTES*c+:8*BUS_BYTES]),
        .data_drop(data_drop[c]),
        .empty(empty[c])
    );
  end

  // ---- Who is next.
  logic [ClientBits-1:0] next_client;
  logic [31:2] next_addr;
  logic [4:0] next_words;

  assign take_place = !held || done;
  ft_arbiter #(
      .CLIENTS(WRITERS)
  ) u_arbiter (
      .clk(clk),
      .rst(rst),
      .request(place_valid),
      .take(take_place),
      .grant(place_grant)
  );

  always_comb begin
    next_client = '0;
    next_addr   = '0;
    next_words  = '0;
    for (int c = 0; c < WRITERS; c++) begin
      if (place_grant[c]) begin
        next_client = next_client | ClientBits'(c);
        next_addr   = next_addr | place_addr[30*c+:30];
        next_words  = next_words | place_words[5*c+:5];
      end
    end
  end

  always_ff @(posedge clk) begin
    if (rst) held <= 1'b0;
    else if (take_place) held <= |place_valid;
    if (take_place) begin
      first  <= 1'b1;
      client <= next_client;
      addr   <= next_addr;
      word   <= next_addr[5:2];
      left   <= next_words;
    end else if (w_load) begin
      first <= 1'b0;
      word  <= (word | 4'(Words - 1)) + 4'd1;
      left  <= 5'(past - 6'(Words));
    end
  end

  // ---- Its beats. One that is not wanted goes at once; of the cache's writes, in their order.
  logic aw_room;
  logic [FlightBits-1:0] in_flight;
  logic is_cache;

  ft_window u_window (
      .block(addr[31:6]),
      .first(window_first),
      .behind(window_behind),
      .outside(outside)
  );
  assign is_cache = 32'(client) == CACHE_WRITER;
  assign from     = word & 4'(Words - 1);
  assign past     = 6'(from) + 6'(left);
  assign last     = past <= 6'(Words);
  assign room     = (!w_valid || w_take) && (!first || (aw_room && in_flight != FlightBits'(WRITES_IN_FLIGHT)));
  assign drop     = held && first && (outside || cancel) && (!is_cache || (order_settled && !b_valid));
  assign w_load   = held && room && !(first && (outside || cancel));
  assign done     = drop || (w_load && last);

  always_ff @(posedge clk) begin
    if (rst) w_valid <= 1'b0;
    else if (w_load) w_valid <= 1'b1;
    else if (w_take) w_valid <= 1'b0;
    if (w_load) begin
      w_data <= beats[8*BUS_BYTES*32'(client)+:8*BUS_BYTES];
      w_last <= last;
      for (int i = 0; i < Words; i++) begin
        w_strb[4*i+:4] <= {4{6'(i) >= 6'(from) && 6'(i) < past}};
      end
    end
  end

  // ---- Its address.
  logic [3:0] len;
  logic aw_push;
  logic [2:0] aw_count;
  assign aw_push = w_load && first;
  assign len = 4'((past - 6'd1) >> WordBits);
  ft_fifo #(
      .WIDTH(ID_BITS + 34),
      .DEPTH(4)
  ) u_addresses (
      .clk(clk),
      .rst(rst),
      .in_valid(aw_push),
      .in_ready(aw_room),
      .in_data({ID_BITS'(client), addr, len}),
      .out_valid(aw_valid),
      .out_ready(aw_ready),
      .out_data({aw_id, aw_addr[31:2], aw_len[3:0]}),
      .count(aw_count)
  );
  assign aw_addr[1:0] = 2'b00;
  assign aw_len[7:4]  = 4'd0;

  // ---- What is not answered.
  always_ff @(posedge clk) begin
    if (rst) in_flight <= '0;
    else in_flight <= in_flight + FlightBits'(aw_push) - FlightBits'(b_valid);
  end

  ft_write_order #(
      .ENTRIES(ORDER_ENTRIES)
  ) u_order (
      .clk(clk),
      .rst(rst),
      .ready(order_ready),
      .push(wr_valid[CACHE_WRITER] && wr_ready[CACHE_WRITER]),
      .push_addr(wr_addr[32*CACHE_WRITER+3+:29]),
      .sent(aw_push && is_cache),
      .dropped(drop && is_cache),
      .answered(b_valid && b_id == ID_BITS'(CACHE_WRITER)),
      .settled(order_settled),
      .addr(order_addr),
      .match(order_match),
      .leave(order_leave)
  );

  assign idle       = &empty && in_flight == '0;
  assign stray      = drop && !cancel;
  assign stray_addr = {addr, 2'b00};

`ifndef SYNTHESIS
  always_ff @(posedge clk) begin
    if (!rst) begin
      assert (!b_valid || in_flight != '0) else $error("ft_bus_writes: an answer to nothing");
    end
  end
`endif

  wire unused = &{1'b0, wr_data, aw_count};
endmodule
