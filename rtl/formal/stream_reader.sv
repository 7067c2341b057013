// SPDX-License-Identifier: Apache-2.0
// ft_stream_reader: a burst's address stays until memory takes it; each burst is asked for once, in
// order and inside the window; what comes is handed on in order, with zeros for what lies
// outside the window, and done means that all was taken. For streams of up to fifteen words, half of them
// inside, and bursts of two beats.
// engine: pdr
// sources: common/ft_fifo.sv system/ft_window.sv system/ft_stream_reader.sv
// fault: system/ft_stream_reader.sv: + BUS_BYTES / 4 - 1) >> => ) >>
// fault: system/ft_stream_reader.sv: outside && !cancel && in_flight == '0; => outside && !cancel;
// fault: system/ft_stream_reader.sv: (!ar_valid || ar_ready); => 1'b1;
// fault: system/ft_stream_reader.sv: assign done       = !left && reserved == '0; => assign done       = !left && in_flight == '0;
module proof (
    input logic       clk,
    input logic       begin_one,
    input logic [3:0] words,
    input logic       rd_ready,
    input logic       ar_ready,
    input logic       answer
);
  logic rst = 1'b1;
  always_ff @(posedge clk) rst <= 1'b0;

  logic start, done, reading, stray, rd_valid, ar_valid, r_valid, r_last, sent, take;
  logic [31:0] stray_addr, ar_addr;
  logic [7:0] ar_len;
  logic [63:0] rd_data;

  assign start = begin_one && done && !rst;
  ft_stream_reader #(.BUS_BYTES(8), .READ_AHEAD(32), .BURST(16), .READS_IN_FLIGHT(2)) dut (
      .clk, .rst, .cancel(1'b0), .window_first(26'd0), .window_behind(26'd1),
      .start, .addr(32'd32), .bytes({26'd0, words, 2'd0}), .done, .reading, .stray, .stray_addr,
      .rd_valid, .rd_ready, .rd_data, .ar_valid, .ar_ready, .ar_addr, .ar_len, .r_valid, .r_last,
      .r_data(64'd1)
  );
  assign sent = ar_valid && ar_ready;
  assign take = rd_valid && rd_ready;

  // Memory: up to three bursts, of two beats or of one, the first of them in front.
  logic [2:0] bursts;         // there is one
  logic [2:0] two;            // it has two beats to come
  logic [2:0] stay, behind;   // after this cycle; the place of the next one
  assign r_valid = answer && bursts[0];
  assign r_last  = !two[0];
  assign stay    = r_valid && r_last ? bursts >> 1 : bursts;
  assign behind  = ~stay & {stay[1:0], 1'b1};

  logic ar_waits;
  logic [39:0] ar_was;
  logic [3:0] left;  // beats of the stream to take
  logic [2:0] next;  // burst
  logic [3:0] gone;  // beats taken

  always_ff @(posedge clk) begin
    ar_waits <= !rst && ar_valid && !ar_ready;
    ar_was   <= {ar_addr, ar_len};
    if (rst) begin
      bursts <= '0;
      two    <= '0;
      left   <= '0;
    end else begin
      // The front leaves, and a new one goes behind the last.
      bursts <= stay | (sent ? behind : 3'd0);
      two    <= (r_valid && r_last ? two >> 1 : two & ~{2'd0, r_valid}) |
                (sent && ar_len[0] ? behind : 3'd0);
      if (sent) begin
        assert (!bursts[2] && ar_len <= 8'd1 && ar_addr == 32'd32 + {25'd0, next, 4'd0});
        assert (ar_addr < 32'd64);
        next <= next + 1'b1;
      end
      if (start) begin
        gone <= '0;
        left <= {1'b0, words[3:1]} + 4'(words[0]);
        next <= '0;
      end else if (take) begin
        assert (left != '0);
        left <= left - 1'b1;
        gone <= gone + 1'b1;
        assert (rd_data == (gone < 4'd4 ? 64'd1 : 64'd0));
      end
      if (!start) assert (done == (left == '0));
      if (ar_waits) assert (ar_valid && {ar_addr, ar_len} == ar_was);
      assert (reading || bursts == '0);
    end
  end
endmodule
