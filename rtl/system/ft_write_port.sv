// SPDX-License-Identifier: Apache-2.0
// The bus's end of a write client: a queue of requests, each a part of one aligned block. The
// requests' places and their data are taken separately, so that the bus can look at a request while
// it moves the data of the one before.
module ft_write_port #(
    parameter int BLOCK = 64,      // bytes: a power of two from 4 to 64
    parameter int BUS_BYTES = 16,  // a power of two from 8 to 64
    parameter int DEPTH = 4,       // requests: a power of two
    parameter bit ZEROS = 1'b0     // the client writes nothing but zeros: its data is not kept
) (
    input  logic                   clk,
    input  logic                   rst,
    // The client's request: `bytes` at `addr`, multiples of four; byte i of the block in [8*i+:8].
    input  logic                   wr_valid,
    output logic                   wr_ready,
    input  logic [31:0]            wr_addr,
    input  logic [6:0]             wr_bytes,
    input  logic [8*BLOCK-1:0]     wr_data,
    // The oldest request whose place was not taken yet, in words of four bytes.
    output logic                   place_valid,
    input  logic                   place_take,
    output logic [31:2]            place_addr,
    output logic [4:0]             place_words,
    // Data of the oldest request, the beat that holds word `word` of the aligned 64 bytes.
    input  logic [3:0]             word,
    output logic [8*BUS_BYTES-1:0] beat,
    input  logic                   data_drop,  // it is done with; its place was taken before
    output logic                   empty
);
  localparam int PointerBits = $clog2(DEPTH);

  logic [34:0] places[0:DEPTH-1];
  logic [PointerBits-1:0] tail, place_head, data_head;
  logic [PointerBits:0] waiting;  // places not taken
  logic [PointerBits:0] held;     // requests
  logic push;

  assign wr_ready    = held != (PointerBits + 1)'(DEPTH);
  assign push        = wr_valid && wr_ready;
  assign place_valid = waiting != '0;
  assign {place_addr, place_words} = places[place_head];
  assign empty       = held == '0;

  always_ff @(posedge clk) begin
    if (push) places[tail] <= {wr_addr[31:2], wr_bytes[6:2]};
    if (rst) begin
      tail       <= '0;
      place_head <= '0;
      data_head  <= '0;
      waiting    <= '0;
      held       <= '0;
    end else begin
      if (push) tail <= tail + 1'b1;
      if (place_take) place_head <= place_head + 1'b1;
      if (data_drop) data_head <= data_head + 1'b1;
      if (push && !place_take) waiting <= waiting + 1'b1;
      if (!push && place_take) waiting <= waiting - 1'b1;
      if (push && !data_drop) held <= held + 1'b1;
      if (!push && data_drop) held <= held - 1'b1;
    end
  end

  if (ZEROS) begin : g_zeros
    assign beat = '0;
  end else begin : g_data
    logic [8*BLOCK-1:0] blocks[0:DEPTH-1];
    logic [8*BLOCK-1:0] block;
    assign block = blocks[data_head];
    always_ff @(posedge clk) if (push) blocks[tail] <= wr_data;
    if (BLOCK > BUS_BYTES) begin : g_part
      assign beat = block[8*BUS_BYTES*32'(word[$clog2(BLOCK)-3:$clog2(BUS_BYTES)-2])+:8*BUS_BYTES];
    end else begin : g_copies
      assign beat = {(BUS_BYTES / BLOCK) {block}};
    end
  end

`ifndef SYNTHESIS
  logic [6:0] behind;
  assign behind = 7'(wr_addr & 32'(BLOCK - 1)) + wr_bytes;
  always_ff @(posedge clk) begin
    if (!rst) begin
      if (wr_valid) begin
        assert (wr_addr[1:0] == '0 && wr_bytes[1:0] == '0 && wr_bytes != '0)
        else $error("ft_write_port: a request of broken words");
        assert (32'(behind) <= BLOCK) else $error("ft_write_port: a request leaves its block");
        assert (!ZEROS || wr_data == '0) else $error("ft_write_port: data where zeros were promised");
      end
      assert (!(place_take && waiting == '0)) else $error("ft_write_port: took a place from none");
      assert (!(data_drop && held == waiting)) else $error("ft_write_port: dropped data not looked at");
    end
  end
`endif

  wire unused = &{1'b0, word, wr_addr[1:0], wr_bytes[1:0], wr_data};
endmodule
