// SPDX-License-Identifier: Apache-2.0
// Bit encoding unit (BEU): clears the marks, then gathers the marks of 32 neighbouring nodes into a
// word and writes it through the cache. Docs: docs/accelerator/bit_encoding.md.
module ft_bit_encoding #(
    parameter int QUEUE = 4  // nodes
) (
    input  logic         clk,
    input  logic         rst,
    input  logic         start_clear,  // zeros over `mark_bytes` from `marks` on
    input  logic         start_marks,  // of `nodes` nodes
    input  logic [31:0]  marks,        // address, of a block of 64 bytes
    input  logic [31:0]  mark_bytes,   // a multiple of 4
    input  logic [31:0]  nodes,
    input  logic         mark_valid,
    output logic         mark_ready,
    input  logic [31:0]  mark_index,   // ascending
    output logic         wr_valid,
    input  logic         wr_ready,
    output logic [31:0]  wr_addr,
    output logic [6:0]   wr_bytes,
    output logic [511:0] wr_data,
    output logic         req_valid,
    input  logic         req_ready,
    output logic [31:0]  req_addr,
    output logic         req_write,
    output logic [31:0]  req_word,
    output logic         done,
    output logic [3:0]   activity  // stalled on: the bus, mark_cache
);
  // Zeros.
  logic [25:0] clear_block, clear_blocks;  // the next one, and how many whole ones are left
  logic [5:0] clear_rest;                  // bytes behind them
  logic clearing;

  assign clearing = clear_blocks != '0 || clear_rest != '0;
  assign wr_valid = clearing;
  assign wr_addr  = {clear_block, 6'd0};
  assign wr_bytes = clear_blocks != '0 ? 7'd64 : {1'b0, clear_rest};
  assign wr_data  = '0;

  always_ff @(posedge clk) begin
    if (rst) begin
      clear_blocks <= '0;
      clear_rest   <= '0;
    end else if (start_clear) begin
      clear_block  <= marks[31:6];
      clear_blocks <= mark_bytes[31:6];
      clear_rest   <= mark_bytes[5:0];
    end else if (clearing && wr_ready) begin
      clear_block <= clear_block + 1'b1;
      if (clear_blocks != '0) clear_blocks <= clear_blocks - 1'b1;
      else clear_rest <= '0;
    end
  end

  // Marks. Nodes come in order, so that a word is complete when a node of another word comes, or no
  // more nodes.
  logic have, take, leave, holds;
  logic [31:0] index, left;
  logic [26:0] word_index;
  logic [31:0] word, word_addr, bit_of_node;
  logic [$clog2(QUEUE+1)-1:0] unused_count;

  ft_fifo #(.WIDTH(32), .DEPTH(QUEUE)) queue (
      .clk      (clk),
      .rst      (rst),
      .in_valid (mark_valid),
      .in_ready (mark_ready),
      .in_data  (mark_index),
      .out_valid(have),
      .out_ready(take),
      .out_data (index),
      .count    (unused_count)
  );

  assign leave       = holds && !clearing && (have ? index[31:5] != word_index : left == '0);
  assign take        = have && !clearing && (!leave || req_ready);
  assign bit_of_node = 32'd1 << index[4:0];
  assign req_valid   = leave;
  assign req_addr    = word_addr;
  assign req_write   = 1'b1;
  assign req_word    = word;

  always_ff @(posedge clk) begin
    if (take) begin
      word       <= holds && !leave ? word | bit_of_node : bit_of_node;
      word_index <= index[31:5];
      word_addr  <= marks + {3'b000, index[31:5], 2'b00};
    end
    if (rst) begin
      left  <= '0;
      holds <= 1'b0;
    end else if (start_marks) begin
      left  <= nodes;
      holds <= 1'b0;
    end else begin
      if (take) left <= left - 1'b1;
      if (take) holds <= 1'b1;
      else if (leave && req_ready) holds <= 1'b0;
    end
  end

  assign done = !clearing && left == '0 && !holds;

  always_comb begin
    activity = ft_pkg::Idle;
    if (clearing) activity = wr_ready ? ft_pkg::Busy : ft_pkg::Stalled;
    else if (take || (leave && req_ready)) activity = ft_pkg::Busy;
    else if (leave) activity = ft_pkg::Stalled + 4'd1;
  end

`ifndef SYNTHESIS
  always_ff @(posedge clk) begin
    if (!rst) begin
      assert (!take || left != '0) else $error("ft_bit_encoding: more nodes than announced");
      assert (!(take && holds) || index[31:5] >= word_index)
      else $error("ft_bit_encoding: a node out of order");
      assert (!start_clear || (marks[5:0] == '0 && mark_bytes[1:0] == '0))
      else $error("ft_bit_encoding: marks that are not aligned");
      assert (!(start_clear || start_marks) || done) else $error("ft_bit_encoding: started at work");
    end
  end
`endif
endmodule
