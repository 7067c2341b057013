// SPDX-License-Identifier: Apache-2.0
// Gathers items for consecutive addresses into aligned blocks, each a request to a write port.
module ft_block_writer #(
    parameter int BLOCK = 64,  // bytes, a power of two
    parameter int ITEM = 4     // bytes, a power of two, of a part of a block; addresses are multiples of it
) (
    input  logic               clk,
    input  logic               start,  // at the byte address `addr`; what is held is forgotten
    input  logic [31:0]        addr,
    input  logic               put_valid,
    output logic               put_ready,
    input  logic [8*ITEM-1:0]  put_data,
    input  logic               flush,  // hand on what is held; not together with put_valid
    output logic               holds,
    output logic               wr_valid,
    input  logic               wr_ready,
    output logic [31:0]        wr_addr,
    output logic [6:0]         wr_bytes,
    output logic [8*BLOCK-1:0] wr_data
);
  localparam int Items = BLOCK / ITEM;
  localparam int ItemBits = $clog2(Items);
  localparam int ItemShift = $clog2(ITEM);

  logic [31:0] first;                        // address of the first item held, or of the next to come
  logic [ItemBits:0] held;                   // items
  logic [8*BLOCK-1:0] block, merged;
  logic [ItemBits-1:0] place, next_place;    // of the next item in its block, and of the one behind
  logic last;                                // place is a block's last

  assign next_place = place + 1'b1;
  assign holds     = held != '0;
  assign put_ready = !last || wr_ready;
  assign wr_valid  = flush ? holds : put_valid && last;
  assign wr_addr   = first;
  assign wr_bytes  = 7'((32'(held) + (flush ? 32'd0 : 32'd1)) << ItemShift);
  assign wr_data   = merged;

  always_comb begin
    merged = block;
    // Item by item: a part chosen by a variable would be built as a shifter. Where nothing is put,
    // it changes what is not part of the request.
    for (int i = 0; i < Items; i++) begin
      if (place == ItemBits'(i)) merged[8*ITEM*i+:8*ITEM] = put_data;
    end
  end

  always_ff @(posedge clk) begin
    if (put_valid && put_ready) block <= merged;
    if (start) begin
      place <= addr[ItemShift+:ItemBits];
      last  <= &addr[ItemShift+:ItemBits];
    end else if (put_valid && put_ready) begin
      place <= next_place;
      last  <= &next_place;
    end
    if (start) begin
      first <= addr;
      held  <= '0;
    end else if (wr_valid && wr_ready) begin
      first <= first + 32'(wr_bytes);
      held  <= '0;
    end else if (put_valid && put_ready) begin
      held <= held + 1'b1;
    end
  end
endmodule
