// SPDX-License-Identifier: Apache-2.0
// Reads an array in order, ahead of the unit that takes it: asks for bursts of aligned addresses as
// long as its queue has room for what they bring. Bursts outside the window are not asked for; in
// their place come zeros.
module ft_stream_reader #(
    parameter int BUS_BYTES = 16,   // a power of two from 8 to 64
    parameter int READ_AHEAD = 512, // bytes of the queue, a multiple of BUS_BYTES, at least BURST
    parameter int BURST = 64,       // bytes, a power of two from BUS_BYTES to 64
    parameter int READS_IN_FLIGHT = 16
) (
    input  logic                   clk,
    input  logic                   rst,
    input  logic                   cancel,  // level: ask for no more and forget what comes
    input  logic [31:6]            window_first,
    input  logic [31:6]            window_behind,
    input  logic                   start,   // pulse; only while `done`
    input  logic [31:0]            addr,    // a multiple of 4096
    input  logic [31:0]            bytes,   // a multiple of 4
    output logic                   done,    // all of it was taken
    output logic                   reading, // something was asked for that has not come
    output logic                   stray,   // pulse: a burst at `stray_addr` was outside the window
    output logic [31:0]            stray_addr,
    // Towards the unit: beats of BUS_BYTES; the last one may be filled in part.
    output logic                   rd_valid,
    input  logic                   rd_ready,
    output logic [8*BUS_BYTES-1:0] rd_data,
    // Towards memory: a burst of ar_len + 1 beats, and the beats that come. There is always room.
    output logic                   ar_valid,
    input  logic                   ar_ready,
    output logic [31:0]            ar_addr,
    output logic [7:0]             ar_len,
    input  logic                   r_valid,
    input  logic                   r_last,
    input  logic [8*BUS_BYTES-1:0] r_data
);
  localparam int BurstShift = $clog2(BURST);
  localparam int BusShift = $clog2(BUS_BYTES);
  localparam int Depth = READ_AHEAD / BUS_BYTES;
  localparam int BeatBits = $clog2(BURST / BUS_BYTES + 1);
  localparam int CountBits = $clog2(Depth + 1);
  localparam int FlightBits = $clog2(READS_IN_FLIGHT + 1);

  logic [31:BurstShift] next;        // burst to ask for
  logic [31:BurstShift] bursts;      // whole ones still to ask for
  logic [BeatBits-1:0] tail;         // beats of the part of a burst behind them
  logic [BeatBits-1:0] beats;        // of the burst to ask for
  logic [CountBits-1:0] reserved;    // beats asked for or in the queue
  logic [FlightBits-1:0] in_flight;  // bursts
  logic [BeatBits-1:0] zeros;        // beats of zeros to be made up
  logic whole, left, room, outside, ask, make_up, push, pop, queue_valid, queue_ready;
  logic [CountBits-1:0] queue_count;

  assign whole = bursts != '0;
  assign left  = whole || tail != '0;
  assign beats = whole ? BeatBits'(BURST / BUS_BYTES) : tail;
  // Room for a whole burst, though the last one may be shorter: a comparison with a constant.
  assign room  = 32'(reserved) <= Depth - BURST / BUS_BYTES && zeros == '0;

  ft_window u_window (
      .block(next[31:6]),
      .first(window_first),
      .behind(window_behind),
      .outside(outside)
  );

  assign ask     = left && room && !outside && !cancel && in_flight != FlightBits'(READS_IN_FLIGHT) &&
                   (!ar_valid || ar_ready);
  assign make_up = left && room && outside && !cancel && in_flight == '0;

  // What comes of one burst comes in order, and zeros only where no burst is under way.
  assign push = r_valid || zeros != '0;
  assign pop  = queue_valid && (rd_ready || cancel);
  ft_fifo #(
      .WIDTH(8 * BUS_BYTES),
      .DEPTH(Depth)
  ) u_queue (
      .clk(clk),
      .rst(rst),
      .in_valid(push),
      .in_ready(queue_ready),
      .in_data(zeros != '0 ? '0 : r_data),
      .out_valid(queue_valid),
      .out_ready(rd_ready || cancel),
      .out_data(rd_data),
      .count(queue_count)
  );

  assign rd_valid   = queue_valid && !cancel;
  assign reading    = in_flight != '0;
  assign done       = !left && reserved == '0;
  assign stray      = make_up;
  assign stray_addr = {next, {BurstShift{1'b0}}};

  always_ff @(posedge clk) begin
    if (ask) begin
      ar_addr <= {next, {BurstShift{1'b0}}};
      ar_len  <= 8'(beats) - 8'd1;
    end
    if (rst) begin
      ar_valid  <= 1'b0;
      bursts    <= '0;
      tail      <= '0;
      reserved  <= '0;
      in_flight <= '0;
      zeros     <= '0;
    end else begin
      if (ask) ar_valid <= 1'b1;
      else if (ar_ready) ar_valid <= 1'b0;
      if (make_up) zeros <= beats;
      else if (zeros != '0) zeros <= zeros - 1'b1;
      if (cancel) begin
        bursts <= '0;
        tail   <= '0;
      end else if (start) begin
        next   <= addr[31:BurstShift];
        bursts <= bytes[31:BurstShift];
        tail   <= BeatBits'((32'(bytes[BurstShift-1:2]) + BUS_BYTES / 4 - 1) >> (BusShift - 2));
      end else if (ask || make_up) begin
        next <= next + 1'b1;
        if (whole) bursts <= bursts - 1'b1;
        else tail <= '0;
      end
      reserved <= reserved + (ask || make_up ? CountBits'(beats) : '0) - CountBits'(pop);
      in_flight <= in_flight + FlightBits'(ask) - FlightBits'(r_valid && r_last);
    end
  end

`ifndef SYNTHESIS
  always_ff @(posedge clk) begin
    if (!rst) begin
      assert (!start || done) else $error("ft_stream_reader: started before the last one was taken");
      assert (!start || (addr[11:0] == '0 && bytes[1:0] == '0))
      else $error("ft_stream_reader: the array is not aligned");
      assert (!push || queue_ready) else $error("ft_stream_reader: no room for what was asked for");
      assert (!r_valid || in_flight != '0) else $error("ft_stream_reader: data that nobody asked for");
      assert (queue_count <= reserved) else $error("ft_stream_reader: more than was asked for");
    end
  end
`endif

  wire unused = &{1'b0, addr, bytes, queue_ready, queue_count};
endmodule
