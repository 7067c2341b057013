// SPDX-License-Identifier: Apache-2.0
// ft_block_writer: every item that was put in is written once, at its place, with its value; requests
// follow one another without a gap and never cross a block; what is offered stays until it is taken.
// engine: pdr
// sources: common/ft_block_writer.sv
// fault: common/ft_block_writer.sv: !last || wr_ready => 1'b1
// fault: common/ft_block_writer.sv: first <= first + 32'(wr_bytes) => first <= first + 32'(BLOCK)
// fault: common/ft_block_writer.sv: last  <= &next_place => last  <= held == (ItemBits + 1)'(Items - 2)
// fault: common/ft_block_writer.sv: flush ? 32'd0 : 32'd1 => 32'd1
module proof (
    input logic        clk,
    input logic        begins,
    input logic [ 5:0] begin_addr,
    input logic        may_put,
    input logic [ 7:0] new_data,
    input logic        may_flush,
    input logic        wr_ready,
    input logic        mark
);
  localparam int Block = 4, Item = 1;
  logic first_cycle = 1'b1;
  always_ff @(posedge clk) first_cycle <= 1'b0;

  // The user of the writer: starts it first, holds an item until it is taken, and flushes only
  // without one. It starts anew only where nothing is held, and not while it offers or flushes.
  logic start, put_valid, put_ready, flush, holds, wr_valid, offering, flushing;
  logic [7:0] put_data, held_data;
  logic [31:0] addr, wr_addr;
  logic [6:0] wr_bytes;
  logic [31:0] wr_data;
  assign start     = first_cycle || (begins && !offering && !flushing && !holds);
  assign addr      = 32'(begin_addr);
  assign put_valid = !start && !flushing && (offering || may_put);
  assign put_data  = offering ? held_data : new_data;
  assign flush     = !start && !put_valid && (flushing || may_flush);

  ft_block_writer #(.BLOCK(Block), .ITEM(Item)) dut (
      .clk, .start, .addr, .put_valid, .put_ready, .put_data, .flush, .holds,
      .wr_valid, .wr_ready, .wr_addr, .wr_bytes, .wr_data
  );

  logic put, wrote, followed, waited;
  logic [31:0] next_put, next_write, place, offered_addr;
  logic [7:0] data;
  logic [6:0] offered_bytes;
  assign put   = put_valid && put_ready;
  assign wrote = wr_valid && wr_ready;

  always_ff @(posedge clk) begin
    offering      <= put_valid && !put_ready;
    held_data     <= put_data;
    flushing      <= flush && holds && !wr_ready;
    waited        <= wr_valid && !wr_ready;
    offered_addr  <= wr_addr;
    offered_bytes <= wr_bytes;
    if (start) begin
      next_put   <= addr;
      next_write <= addr;
      followed   <= 1'b0;
    end else begin
      if (put) next_put <= next_put + 32'(Item);
      if (wrote) next_write <= next_write + 32'(wr_bytes);
      if (put && mark && !followed) begin
        data  <= put_data;
        place <= next_put;
        // An item may leave in the cycle in which it comes.
        followed <= !wrote;
        if (wrote) assert (wr_data[8*32'(next_put[1:0])+:8] == put_data);
      end else if (wrote) begin
        // A request takes all that is held: what was in it is not written again.
        followed <= 1'b0;
        if (followed) begin
          assert (place - wr_addr < 32'(wr_bytes));
          assert (wr_data[8*32'(place[1:0])+:8] == data);
        end
      end
      assert (holds == (next_put != next_write));
      assert (next_put - next_write < 32'(Block));
      if (wr_valid) begin
        assert (wr_addr == next_write);
        assert (wr_bytes != '0 && 32'(wr_addr[1:0]) + 32'(wr_bytes) <= 32'(Block));
        assert (wr_addr + 32'(wr_bytes) == next_put + (put_valid ? 32'(Item) : 32'd0));
      end
      if (put && !wrote) assert (next_put[1:0] != 2'd3);
      if (waited) assert (wr_valid && wr_addr == offered_addr && wr_bytes == offered_bytes);
    end
    if (first_cycle) begin
      offering <= 1'b0;
      flushing <= 1'b0;
      waited   <= 1'b0;
    end
  end
endmodule
