// SPDX-License-Identifier: Apache-2.0
// First half of step 5: the highest bit in which two neighbouring leaves' codes differ, found by
// shifting right until nothing is left.
module ft_internal_node #(
    parameter int BUS_BYTES = 16,
    parameter int SHIFTS = 1,  // places in a cycle
    parameter int QUEUE = 4    // nodes that may wait for their plane
) (
    input  logic                   clk,
    input  logic                   rst,
    input  logic                   start,
    input  logic [31:0]            leaves,
    input  logic                   rd_valid,
    output logic                   rd_ready,
    input  logic [8*BUS_BYTES-1:0] rd_data,
    output logic                   node_valid,
    input  logic                   node_ready,
    output logic [31:0]            node_code,
    output logic [4:0]             node_bit,
    output logic                   mark_valid,
    input  logic                   mark_ready,
    output logic [31:0]            mark_index,
    output logic                   done,
    output logic [3:0]             activity
);
  localparam int PerBeat = BUS_BYTES / 4;
  localparam int PlaceBits = $clog2(PerBeat);
  localparam logic [PlaceBits-1:0] LastPlace = PlaceBits'(PerBeat - 1);

  // The next code out of the beat in front, and where it differs from the one before it.
  logic [31:0]          left;   // codes to come
  logic [PlaceBits-1:0] place;  // of the next one in its beat
  logic                 first;
  logic                 fetch, load;
  logic                 next_valid;
  logic [31:0]          word, next_code, next_differs;

  assign word     = rd_data[32*32'(place)+:32];
  assign fetch    = rd_valid && left != '0 && (!next_valid || load);
  assign rd_ready = left != '0 && (!next_valid || load) && (place == LastPlace || left == 32'd1);

  always_ff @(posedge clk) begin
    if (fetch) begin
      next_code    <= word;
      next_differs <= word ^ next_code;
      first        <= 1'b0;
      place        <= place + 1'b1;
    end
    if (start) begin
      first <= 1'b1;
      place <= '0;
    end
    if (rst) begin
      left       <= '0;
      next_valid <= 1'b0;
    end else if (start) begin
      left       <= leaves;
      next_valid <= 1'b0;
    end else begin
      if (fetch) left <= left - 1'b1;
      // The first code has none before it.
      next_valid <= fetch ? !first : next_valid && !load;
    end
  end

  // The shifter: what is left of the difference, how far it has gone, and ones from there on.
  logic        shifting, last, hand_on, queue_ready;
  logic [31:0] code, differs, kept;
  logic [4:0]  shifts;
  logic [31:0] kept_last;
  logic [4:0]  shifts_last;

  assign last    = differs[31:SHIFTS] == '0;
  assign hand_on = shifting && last && queue_ready && mark_ready;
  assign load    = next_valid && (!shifting || hand_on);

  // The last step stops on the highest different bit.
  always_comb begin
    kept_last   = kept;
    shifts_last = shifts;
    for (int i = 1; i < SHIFTS; i++) begin
      if (differs[SHIFTS-1:0] >> i != '0) begin
        kept_last   = kept_last << 1;
        shifts_last = shifts_last + 1'b1;
      end
    end
  end

  always_ff @(posedge clk) begin
    if (load) begin
      code    <= next_code;
      differs <= next_differs;
      kept    <= '1;
      shifts  <= '0;
    end else if (!last) begin
      differs <= differs >> SHIFTS;
      kept    <= kept << SHIFTS;
      shifts  <= shifts + 5'(SHIFTS);
    end
    if (rst || start) shifting <= 1'b0;
    else if (load) shifting <= 1'b1;
    else if (hand_on) shifting <= 1'b0;
  end

  assign mark_valid = shifting && last && queue_ready;
  assign mark_index = (code & kept_last) << 1;

  logic [$clog2(QUEUE+1)-1:0] queued;
  ft_fifo #(.WIDTH(37), .DEPTH(QUEUE)) queue (
      .clk, .rst,
      .in_valid(hand_on), .in_ready(queue_ready), .in_data({code, shifts_last}),
      .out_valid(node_valid), .out_ready(node_ready), .out_data({node_code, node_bit}),
      .count(queued)
  );

  assign done = left == '0 && !next_valid && !shifting && queued == '0;

  always_comb begin
    if (shifting) begin
      if (!last || hand_on) activity = ft_pkg::Busy;
      else if (!queue_ready) activity = ft_pkg::Stalled + 4'd1;  // the plane
      else activity = ft_pkg::Stalled + 4'd2;                    // the bit encoding unit
    end else if (fetch || next_valid) begin
      activity = ft_pkg::Busy;
    end else begin
      activity = left == '0 ? ft_pkg::Idle : ft_pkg::Stalled;  // the bus
    end
  end

`ifndef SYNTHESIS
  always_ff @(posedge clk) begin
    if (!rst) begin
      assert (!load || next_differs != '0) else $error("ft_internal_node: two leaves of one code");
      assert (!start || done) else $error("ft_internal_node: started while at work");
    end
  end
`endif
endmodule
