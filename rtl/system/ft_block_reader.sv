// SPDX-License-Identifier: Apache-2.0
// Reads single words of 8 bytes. A read goes to memory once the writes that it must see have taken
// effect; one outside the window is answered with zeros.
module ft_block_reader #(
    parameter int BUS_BYTES = 16,  // a power of two from 8 to 64
    parameter int READS = 4,       // under way or not taken yet, a power of two
    parameter int ENTRIES = 8      // of the writes to be waited for
) (
    input  logic                   clk,
    input  logic                   rst,
    input  logic                   cancel,  // level: forget what comes
    input  logic [31:6]            window_first,
    input  logic [31:6]            window_behind,
    input  logic                   rdq_valid,
    output logic                   rdq_ready,
    input  logic [31:3]            rdq_addr,
    output logic                   rdd_valid,
    input  logic                   rdd_ready,
    output logic [63:0]            rdd_data,
    output logic                   done,     // nothing asked for, nothing to take
    output logic                   reading,  // something was asked for that has not come
    output logic                   stray,    // pulse: a read at `stray_addr` was outside the window
    output logic [31:0]            stray_addr,
    input  logic [ENTRIES-1:0]     match,    // writes to rdq_addr that are under way
    input  logic [ENTRIES-1:0]     leave,    // writes that end in this cycle
    output logic                   ar_valid,
    input  logic                   ar_ready,
    output logic [31:0]            ar_addr,
    input  logic                   r_valid,
    input  logic [8*BUS_BYTES-1:0] r_data
);
  localparam int CountBits = $clog2(READS + 1);
  localparam int PointerBits = $clog2(READS);

  logic held;                  // a request not sent yet
  logic [31:3] addr;
  logic outside, outside_in;
  logic [ENTRIES-1:0] waits;   // for these writes
  logic [CountBits-1:0] reserved, in_flight;
  logic sent, make_up, pop, push, queue_ready, queue_valid;
  logic [CountBits-1:0] queue_count;
  logic [63:0] word;

  ft_window u_window (
      .block(rdq_addr[31:6]),
      .first(window_first),
      .behind(window_behind),
      .outside(outside_in)
  );

  // What is held has its place in the queue of answers.
  assign rdq_ready  = !held && reserved != CountBits'(READS) && !cancel;
  assign ar_valid   = held && !outside && waits == '0;
  assign ar_addr    = {addr, 3'b000};
  assign sent       = ar_valid && ar_ready;
  assign make_up    = held && outside && in_flight == '0;
  assign stray      = make_up && !cancel;
  assign stray_addr = ar_addr;
  assign reading    = in_flight != '0;
  assign done       = reserved == '0;

  // Answers come in order: which word of the beat it is was put down when it was asked for.
  if (BUS_BYTES > 8) begin : g_word
    localparam int PlaceBits = $clog2(BUS_BYTES) - 3;
    logic [PlaceBits-1:0] places[0:READS-1];
    logic [PointerBits-1:0] place_head, place_tail;
    always_ff @(posedge clk) begin
      if (sent) places[place_tail] <= addr[3+:PlaceBits];
      if (rst) begin
        place_head <= '0;
        place_tail <= '0;
      end else begin
        if (sent) place_tail <= place_tail + 1'b1;
        if (r_valid) place_head <= place_head + 1'b1;
      end
    end
    assign word = r_data[64*32'(places[place_head])+:64];
  end else begin : g_whole
    assign word = r_data;
  end

  assign push = r_valid || make_up;
  assign rdd_valid = queue_valid && !cancel;
  assign pop = queue_valid && (rdd_ready || cancel);
  ft_fifo #(
      .WIDTH(64),
      .DEPTH(READS)
  ) u_queue (
      .clk(clk),
      .rst(rst),
      .in_valid(push),
      .in_ready(queue_ready),
      .in_data(make_up ? 64'd0 : word),
      .out_valid(queue_valid),
      .out_ready(rdd_ready || cancel),
      .out_data(rdd_data),
      .count(queue_count)
  );

  always_ff @(posedge clk) begin
    if (rdq_valid && rdq_ready) begin
      addr    <= rdq_addr;
      outside <= outside_in;
    end
    if (rst) begin
      held      <= 1'b0;
      waits     <= '0;
      reserved  <= '0;
      in_flight <= '0;
    end else begin
      if (rdq_valid && rdq_ready) begin
        held  <= 1'b1;
        waits <= match & ~leave;
      end else begin
        waits <= waits & ~leave;
        if (sent || make_up) held <= 1'b0;
      end
      reserved  <= reserved + CountBits'(rdq_valid && rdq_ready) - CountBits'(pop);
      in_flight <= in_flight + CountBits'(sent) - CountBits'(r_valid);
    end
  end

`ifndef SYNTHESIS
  always_ff @(posedge clk) begin
    if (!rst) begin
      assert (!push || queue_ready) else $error("ft_block_reader: no room for what was asked for");
      assert (!r_valid || in_flight != '0) else $error("ft_block_reader: data that nobody asked for");
      assert (!(r_valid && make_up)) else $error("ft_block_reader: zeros overtook data");
    end
  end
`endif

  wire unused = &{1'b0, queue_ready, queue_count};
endmodule
