// SPDX-License-Identifier: Apache-2.0
// The bus between the units and off-chip memory: an AXI4 master. Docs: docs/accelerator/bus.md.
//
// Write clients, by their place in the vectors wr_*: 0 pairs (MCGU), 1 sort, 2 leaf codes,
// 3 leaf rows, 4 nodes, 5 clear (only zeros), 6 mark cache, 7 links. Each has 64 bytes of wr_data,
// of which a client with a smaller block drives the lowest ones: byte i of its aligned block.
// Reads: one stream, started by the global control for whichever unit the stage needs it, and words
// of 8 bytes for the mark cache, which see all that client CACHE_WRITER wrote in cycles before.
module ft_bus #(
    parameter int BUS_BYTES = 16,  // a power of two from 8 to 64
    parameter int WRITERS = 8,
    parameter int REQUEST_QUEUE = 4,     // requests of each write client, a power of two
    parameter int READ_AHEAD = 512,      // bytes of the stream's queue
    parameter int BURST = 64,            // bytes of the stream's bursts, from BUS_BYTES to 64
    parameter int READS_IN_FLIGHT = 16,  // bursts of the stream
    parameter int WRITES_IN_FLIGHT = 64,
    parameter int DUPLEX = 0,            // reads and writes do not share the cycles
    parameter int ID_BITS = 4,           // AWID is the client; ARID 0 the stream, 1 the cache
    parameter logic [7*WRITERS-1:0] BLOCKS = {
      7'd8, 7'd8, 7'd64, 7'd64, 7'd64, 7'd64, 7'd32, 7'd32
    },                                   // bytes of a block by client, the last client first
    parameter logic [WRITERS-1:0] ZEROS = 8'b0010_0000,  // clients that write only zeros
    parameter int CACHE_WRITER = 6
) (
    input  logic                   clk,
    input  logic                   rst,
    // Level: what is queued is dropped, what went out is carried to its end. Hold it until `quiet`.
    input  logic                   cancel,
    // Pulse: counters and sticky flags to zero.
    input  logic                   clear,
    // [begin, end), multiples of 64; an end of zero is 2^32. Nothing goes out for addresses outside.
    input  logic [31:0]            window_begin,
    input  logic [31:0]            window_end,
    // Nothing queued, held, under way, or waiting to be taken.
    output logic                   quiet,
    output logic [3:0]             activity,     // stalled: 0 memory
    output logic                   stray,        // sticky: a request was outside the window
    output logic [31:0]            stray_addr,   // of the first one
    output logic                   axi_error,    // sticky: an error was answered
    output logic [ID_BITS:0]       axi_error_id, // to the first one: write, and its ID
    output logic [31:0]            read_beats,
    output logic [31:0]            write_beats,
    // The stream: start only while stream_done.
    input  logic                   stream_start,
    input  logic [31:0]            stream_addr,  // a multiple of 4096
    input  logic [31:0]            stream_bytes, // a multiple of 4
    output logic                   stream_done,
    output logic                   rd_valid,
    input  logic                   rd_ready,
    output logic [8*BUS_BYTES-1:0] rd_data,
    // The cache's reads.
    input  logic                   rdq_valid,
    output logic                   rdq_ready,
    input  logic [31:0]            rdq_addr,     // a multiple of 8
    output logic                   rdd_valid,
    input  logic                   rdd_ready,
    output logic [63:0]            rdd_data,
    // Write clients.
    input  logic [WRITERS-1:0]     wr_valid,
    output logic [WRITERS-1:0]     wr_ready,
    input  logic [32*WRITERS-1:0]  wr_addr,
    input  logic [7*WRITERS-1:0]   wr_bytes,
    input  logic [512*WRITERS-1:0] wr_data,
    // AXI4.
    output logic [ID_BITS-1:0]     m_axi_awid,
    output logic [31:0]            m_axi_awaddr,
    output logic [7:0]             m_axi_awlen,
    output logic [2:0]             m_axi_awsize,
    output logic [1:0]             m_axi_awburst,
    output logic                   m_axi_awlock,
    output logic [3:0]             m_axi_awcache,
    output logic [2:0]             m_axi_awprot,
    output logic [3:0]             m_axi_awqos,
    output logic                   m_axi_awvalid,
    input  logic                   m_axi_awready,
    output logic [8*BUS_BYTES-1:0] m_axi_wdata,
    output logic [BUS_BYTES-1:0]   m_axi_wstrb,
    output logic                   m_axi_wlast,
    output logic                   m_axi_wvalid,
    input  logic                   m_axi_wready,
    input  logic [ID_BITS-1:0]     m_axi_bid,
    input  logic [1:0]             m_axi_bresp,
    input  logic                   m_axi_bvalid,
    output logic                   m_axi_bready,
    output logic [ID_BITS-1:0]     m_axi_arid,
    output logic [31:0]            m_axi_araddr,
    output logic [7:0]             m_axi_arlen,
    output logic [2:0]             m_axi_arsize,
    output logic [1:0]             m_axi_arburst,
    output logic                   m_axi_arlock,
    output logic [3:0]             m_axi_arcache,
    output logic [2:0]             m_axi_arprot,
    output logic [3:0]             m_axi_arqos,
    output logic                   m_axi_arvalid,
    input  logic                   m_axi_arready,
    input  logic [ID_BITS-1:0]     m_axi_rid,
    input  logic [8*BUS_BYTES-1:0] m_axi_rdata,
    input  logic [1:0]             m_axi_rresp,
    input  logic                   m_axi_rlast,
    input  logic                   m_axi_rvalid,
    output logic                   m_axi_rready
);
  localparam int OrderEntries = 8;
  localparam logic [ID_BITS-1:0] StreamId = ID_BITS'(0);
  localparam logic [ID_BITS-1:0] CacheId = ID_BITS'(1);
  localparam logic [2:0] Size = 3'($clog2(BUS_BYTES));
  localparam logic [1:0] Incr = 2'b01;
  localparam logic [3:0] Bufferable = 4'b0011;  // and modifiable: any normal memory

  // Constants of both address channels.
  assign {m_axi_awsize, m_axi_awburst, m_axi_awlock} = {Size, Incr, 1'b0};
  assign {m_axi_awcache, m_axi_awprot, m_axi_awqos}  = {Bufferable, 3'b000, 4'd0};
  assign {m_axi_arsize, m_axi_arburst, m_axi_arlock} = {Size, Incr, 1'b0};
  assign {m_axi_arcache, m_axi_arprot, m_axi_arqos}  = {Bufferable, 3'b000, 4'd0};

  // ---- Reads: two sources, which take turns at the address channel.
  logic stream_reading, stream_stray, stream_ar_valid, stream_r_valid;
  logic cache_done, cache_reading, cache_stray, cache_ar_valid, cache_r_valid;
  logic [31:0] stream_stray_addr, cache_stray_addr, stream_ar_addr, cache_ar_addr;
  logic [7:0] stream_ar_len;
  logic [OrderEntries-1:0] order_match, order_leave;
  logic ar_cache, ar_cache_held, ar_waits, ar_last_cache, r_take;

  ft_stream_reader #(
      .BUS_BYTES(BUS_BYTES),
      .READ_AHEAD(READ_AHEAD),
      .BURST(BURST),
      .READS_IN_FLIGHT(READS_IN_FLIGHT)
  ) u_stream (
      .clk(clk),
      .rst(rst),
      .cancel(cancel),
      .window_first(window_begin[31:6]),
      .window_behind(window_end[31:6]),
      .start(stream_start),
      .addr(stream_addr),
      .bytes(stream_bytes),
      .done(stream_done),
      .reading(stream_reading),
      .stray(stream_stray),
      .stray_addr(stream_stray_addr),
      .rd_valid(rd_valid),
      .rd_ready(rd_ready),
      .rd_data(rd_data),
      .ar_valid(stream_ar_valid),
      .ar_ready(m_axi_arready && !ar_cache),
      .ar_addr(stream_ar_addr),
      .ar_len(stream_ar_len),
      .r_valid(stream_r_valid),
      .r_last(m_axi_rlast),
      .r_data(m_axi_rdata)
  );

  ft_block_reader #(
      .BUS_BYTES(BUS_BYTES),
      .ENTRIES(OrderEntries)
  ) u_cache (
      .clk(clk),
      .rst(rst),
      .cancel(cancel),
      .window_first(window_begin[31:6]),
      .window_behind(window_end[31:6]),
      .rdq_valid(rdq_valid),
      .rdq_ready(rdq_ready),
      .rdq_addr(rdq_addr[31:3]),
      .rdd_valid(rdd_valid),
      .rdd_ready(rdd_ready),
      .rdd_data(rdd_data),
      .done(cache_done),
      .reading(cache_reading),
      .stray(cache_stray),
      .stray_addr(cache_stray_addr),
      .match(order_match),
      .leave(order_leave),
      .ar_valid(cache_ar_valid),
      .ar_ready(m_axi_arready && ar_cache),
      .ar_addr(cache_ar_addr),
      .r_valid(cache_r_valid),
      .r_data(m_axi_rdata)
  );

  assign ar_cache = ar_waits ? ar_cache_held : cache_ar_valid && !(stream_ar_valid && ar_last_cache);
  assign m_axi_arvalid = stream_ar_valid || cache_ar_valid;
  assign m_axi_arid    = ar_cache ? CacheId : StreamId;
  assign m_axi_araddr  = ar_cache ? cache_ar_addr : stream_ar_addr;
  assign m_axi_arlen   = ar_cache ? 8'd0 : stream_ar_len;

  always_ff @(posedge clk) begin
    ar_cache_held <= ar_cache;
    if (rst) begin
      ar_waits      <= 1'b0;
      ar_last_cache <= 1'b0;
    end else begin
      ar_waits <= m_axi_arvalid && !m_axi_arready;
      if (m_axi_arvalid && m_axi_arready) ar_last_cache <= ar_cache;
    end
  end

  assign r_take         = m_axi_rvalid && m_axi_rready;
  assign stream_r_valid = r_take && m_axi_rid == StreamId;
  assign cache_r_valid  = r_take && m_axi_rid != StreamId;

  // ---- Writes.
  logic w_valid, w_take, w_next, turn_write;
  logic write_load, writes_idle, write_stray;
  logic [31:0] write_stray_addr;

  ft_bus_writes #(
      .BUS_BYTES(BUS_BYTES),
      .WRITERS(WRITERS),
      .REQUEST_QUEUE(REQUEST_QUEUE),
      .WRITES_IN_FLIGHT(WRITES_IN_FLIGHT),
      .ID_BITS(ID_BITS),
      .BLOCKS(BLOCKS),
      .ZEROS(ZEROS),
      .CACHE_WRITER(CACHE_WRITER),
      .ORDER_ENTRIES(OrderEntries)
  ) u_writes (
      .clk(clk),
      .rst(rst),
      .cancel(cancel),
      .window_first(window_begin[31:6]),
      .window_behind(window_end[31:6]),
      .wr_valid(wr_valid),
      .wr_ready(wr_ready),
      .wr_addr(wr_addr),
      .wr_bytes(wr_bytes),
      .wr_data(wr_data),
      .idle(writes_idle),
      .stray(write_stray),
      .stray_addr(write_stray_addr),
      .order_addr(rdq_addr[31:3]),
      .order_match(order_match),
      .order_leave(order_leave),
      .aw_valid(m_axi_awvalid),
      .aw_ready(m_axi_awready),
      .aw_id(m_axi_awid),
      .aw_addr(m_axi_awaddr),
      .aw_len(m_axi_awlen),
      .w_load(write_load),
      .w_valid(w_valid),
      .w_take(w_take),
      .w_data(m_axi_wdata),
      .w_strb(m_axi_wstrb),
      .w_last(m_axi_wlast),
      .b_valid(m_axi_bvalid),
      .b_id(m_axi_bid)
  );
  assign m_axi_bready = 1'b1;

  // ---- Turns: one data beat a cycle, by whole bursts. The turn passes when a burst ends, or when
  // nothing is there to cross; it is known a cycle ahead, so that both sides start on registers.
  assign w_next       = write_load || (w_valid && !w_take);
  assign m_axi_rready = DUPLEX != 0 || !turn_write;
  assign m_axi_wvalid = w_valid && (DUPLEX != 0 || turn_write);
  assign w_take       = m_axi_wvalid && m_axi_wready;

  always_ff @(posedge clk) begin
    if (rst) turn_write <= 1'b0;
    else if (!turn_write) turn_write <= w_next && (!m_axi_rvalid || m_axi_rlast);
    else if (!w_valid || (w_take && m_axi_wlast)) turn_write <= w_next && !m_axi_rvalid;
  end

  // ---- What control sees.
  assign quiet = writes_idle && stream_done && !stream_reading && cache_done;
  assign activity = r_take || w_take ? ft_pkg::Busy
                  : stream_reading || cache_reading || !writes_idle ? ft_pkg::Stalled : ft_pkg::Idle;

  always_ff @(posedge clk) begin
    if (rst || clear) begin
      stray       <= 1'b0;
      axi_error   <= 1'b0;
      read_beats  <= '0;
      write_beats <= '0;
    end else begin
      if (stream_stray || cache_stray || write_stray) stray <= 1'b1;
      if (!stray)
        stray_addr <= stream_stray ? stream_stray_addr : cache_stray ? cache_stray_addr : write_stray_addr;
      if ((r_take && m_axi_rresp[1]) || (m_axi_bvalid && m_axi_bresp[1])) axi_error <= 1'b1;
      if (!axi_error)
        axi_error_id <= r_take && m_axi_rresp[1] ? {1'b0, m_axi_rid} : {1'b1, m_axi_bid};
      read_beats  <= read_beats + 32'(r_take);
      write_beats <= write_beats + 32'(w_take);
    end
  end

`ifndef SYNTHESIS
  ft_axi_rules #(
      .BUS_BYTES(BUS_BYTES),
      .ID_BITS(ID_BITS)
  ) u_rules (
      .clk(clk),
      .rst(rst),
      .aw_valid(m_axi_awvalid),
      .aw_ready(m_axi_awready),
      .aw_addr(m_axi_awaddr),
      .aw_len(m_axi_awlen),
      .aw_id(m_axi_awid),
      .w_valid(m_axi_wvalid),
      .w_ready(m_axi_wready),
      .w_data(m_axi_wdata),
      .w_strb(m_axi_wstrb),
      .w_last(m_axi_wlast),
      .ar_valid(m_axi_arvalid),
      .ar_ready(m_axi_arready),
      .ar_addr(m_axi_araddr),
      .ar_len(m_axi_arlen),
      .ar_id(m_axi_arid)
  );
  always_ff @(posedge clk) begin
    if (!rst) begin
      assert (window_begin[5:0] == '0 && window_end[5:0] == '0)
      else $error("ft_bus: the window is not aligned");
      assert (!rdq_valid || rdq_addr[2:0] == '0) else $error("ft_bus: a read of broken words");
      assert (DUPLEX != 0 || !(r_take && w_take)) else $error("ft_bus: two beats in a cycle");
      assert (!r_take || m_axi_rid == StreamId || m_axi_rid == CacheId)
      else $error("ft_bus: data for nobody");
      assert (!m_axi_bvalid || !writes_idle) else $error("ft_bus: an answer to nothing");
    end
  end
`endif

  wire unused = &{1'b0, window_begin[5:0], window_end[5:0], rdq_addr[2:0], m_axi_rresp[0], m_axi_bresp[0]};
endmodule
