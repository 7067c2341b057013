// SPDX-License-Identifier: Apache-2.0
// ft_bit_encoding: the zeros cover the marks and nothing else; what is offered to bus and cache stays
// until it is taken; of the marks, any one is in the word that goes to its place; and it is done when
// all were taken. For nodes in order among two bits of each of four
// words.
// engine: pdr
// sources: common/ft_fifo.sv units/ft_bit_encoding.sv
// fault: units/ft_bit_encoding.sv: clear_blocks != '0 ? 7'd64 : {1'b0, clear_rest}; => 7'd64;
// fault: units/ft_bit_encoding.sv: holds && !leave ? word | bit_of_node : bit_of_node; => bit_of_node;
// fault: units/ft_bit_encoding.sv: have && !clearing && (!leave || req_ready); => have && !clearing;
// fault: units/ft_bit_encoding.sv: assign done = !clearing && left == '0 && !holds; => assign done = !clearing && left == '0;
module proof (
    input logic       clk,
    input logic       clear,
    input logic       encode,
    input logic [7:2] bytes,
    input logic [2:0] nodes,
    input logic       mark_valid,
    input logic [2:0] index,  // word, bit
    input logic       wr_ready,
    input logic       req_ready,
    input logic       mark        // of all nodes, this is the one to follow
);
  logic rst = 1'b1;
  always_ff @(posedge clk) rst <= 1'b0;

  logic start_clear, start_marks, mark_ready, wr_valid, req_valid, req_write, done, put;
  logic [31:0] wr_addr, req_addr, req_word;
  logic [6:0] wr_bytes;
  logic [511:0] wr_data;
  logic [3:0] activity;

  // Whoever uses the unit starts it when it is done, and brings what was announced, in order.
  logic [2:0] announced, least;  // nodes to come; the next one is this or a later one
  logic bring;
  assign start_clear = clear && done && !encode && !rst;
  assign start_marks = encode && done && !rst;
  assign bring = mark_valid && announced != '0 && index >= least;
  assign put   = bring && mark_ready;

  ft_bit_encoding #(.QUEUE(2)) dut (
      .clk, .rst, .start_clear, .start_marks, .marks(32'h1000), .mark_bytes({24'd0, bytes, 2'd0}),
      .nodes({29'd0, nodes}), .mark_valid(bring),
      .mark_ready, .mark_index({25'd0, index[2:1], 4'd0, index[0]}),
      .wr_valid, .wr_ready, .wr_addr, .wr_bytes, .wr_data,
      .req_valid, .req_ready, .req_addr, .req_write, .req_word, .done, .activity
  );

  logic [8:0] zeros, zeros_end;  // bytes written so far, of so many
  logic followed, wr_waits, req_waits;
  logic [2:0] which;
  logic [38:0] wr_was;
  logic [34:0] req_was;

  always_ff @(posedge clk) begin
    wr_waits  <= !rst && wr_valid && !wr_ready;
    wr_was    <= {wr_addr, wr_bytes};
    req_waits <= !rst && req_valid && !req_ready;
    req_was   <= {req_addr[2:0], req_word};
    if (rst) begin
      announced <= '0;
      zeros     <= '0;
      zeros_end <= '0;
      followed  <= 1'b0;
    end else begin
      if (start_clear) begin
        zeros     <= '0;
        zeros_end <= {1'b0, bytes, 2'd0};
      end else if (wr_valid && wr_ready) begin
        zeros <= zeros + 9'(wr_bytes);
        assert (wr_addr == 32'h1000 + 32'(zeros) && wr_bytes != '0 && wr_data == '0);
      end
      assert (zeros <= zeros_end);
      assert (wr_valid == (zeros != zeros_end));

      if (start_marks) begin
        announced <= nodes;
        least     <= '0;
        end else if (put) begin
        announced <= announced - 1'b1;
        least     <= index;
      end
      if (put && mark && !followed) begin
        followed <= 1'b1;
        which    <= index;
      end
      if (followed && req_valid && req_addr == 32'h1000 + {28'd0, which[2:1], 2'd0}) begin
        assert (req_write && req_word[5'(which[0])]);
        if (req_ready) followed <= 1'b0;
      end

      assert (!(done && (followed || announced != '0 || zeros != zeros_end)));
      if (wr_waits) assert (wr_valid && {wr_addr, wr_bytes} == wr_was);
      if (req_waits) assert (req_valid && {req_addr[2:0], req_word} == req_was);
    end
  end
endmodule
