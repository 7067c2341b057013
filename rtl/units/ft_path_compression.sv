// SPDX-License-Identifier: Apache-2.0
// Path compression unit (PCU): climbs from each node of the tree to its essential ancestor, reading
// marks through the cache, and writes the node there as a child. A look takes two cycles: the
// request goes out, and while the cache looks, the next step up is made ready in case it is needed.
// Docs: docs/accelerator/path_compression.md.
module ft_path_compression #(
    parameter int BUS_BYTES = 16,
    parameter int STEP_CYCLES = 1  // from an answer to the next request
) (
    input  logic                   clk,
    input  logic                   rst,
    input  logic                   start,
    input  logic [31:0]            leaves,
    input  logic [4:0]             depth,
    input  logic [31:0]            marks,  // addresses; that of the nodes a multiple of 16
    input  logic [31:0]            nodes,
    input  logic                   rd_valid,
    output logic                   rd_ready,
    input  logic [8*BUS_BYTES-1:0] rd_data,  // codes of leaves, ascending
    output logic                   req_valid,
    input  logic                   req_ready,
    output logic [31:0]            req_addr,
    output logic                   req_write,
    output logic [31:0]            req_word,
    input  logic                   ans_valid,
    output logic                   ans_ready,
    input  logic [31:0]            ans_word,
    output logic                   wr_valid,
    input  logic                   wr_ready,
    output logic [31:0]            wr_addr,
    output logic [6:0]             wr_bytes,
    output logic [63:0]            wr_data,
    output logic [31:0]            root,
    output logic [31:0]            steps,
    output logic                   done,
    output logic [3:0]             activity  // stalled on: the bus (reading, writing), mark_cache
);
  localparam int Words = BUS_BYTES / 4;
  localparam int WordBits = $clog2(Words);
  localparam logic [5:0] FirstPause = STEP_CYCLES > 1 ? 6'(STEP_CYCLES - 2) : 6'd0;

  typedef enum logic [1:0] {
    NextLeaf,
    Climb,  // a request that has to wait
    Look,   // the cache looks; no answer comes so soon
    Mark
  } state_t;
  state_t state;

  // The next leaf, made ready ahead: its code and where the mark of its parent is.
  logic [WordBits-1:0] place;  // of the next code in its beat
  logic [31:0] left;           // codes that have not been fetched
  logic [31:0] code;           // the next one
  logic fetch, next_valid, next_take;
  logic [30:0] next_code;
  logic [31:0] next_addr;
  logic [31:0] next_leaf;      // its index

  assign code     = rd_data[32*32'(place)+:32];
  assign fetch    = rd_valid && !next_valid && left != '0;
  assign rd_ready = !next_valid && left != '0 && (&place || left == 32'd1);

  always_ff @(posedge clk) begin
    if (!next_valid) begin
      next_code <= code[30:0];
      next_addr <= marks + {2'b00, code[31:4], 2'b00};
    end
    if (rst) begin
      left       <= '0;
      next_valid <= 1'b0;
    end else if (start) begin
      left       <= leaves;
      place      <= '0;
      next_valid <= 1'b0;
      next_leaf  <= '0;
    end else begin
      if (fetch) begin
        left       <= left - 1'b1;
        place      <= place + 1'b1;
        next_valid <= 1'b1;
      end
      if (next_take) begin
        next_valid <= 1'b0;
        next_leaf  <= next_leaf + 1'b1;
      end
    end
  end

  // What climbs: how its parent names it, its last leaf, and the leaf before its first one (the
  // first leaf less one is the rank of the parent, for an upper child). Of each ancestor that is
  // still open, `before_open` keeps the leaf before its first one, by level.
  logic [31:0] child, leaf, previous, opened;
  logic [31:0] before_open[0:31];

  // The parent whose mark is looked at.
  logic [31:0] parent, low;  // node index, and its lowest set bit alone
  logic [4:0]  level;        // the place of that bit
  logic        upper;        // what climbs is the upper child
  logic [29:0] above;        // bits of the index above `low`

  // The step after that, ready from the second cycle of a look on.
  logic [31:0] ask_parent, ask_addr;
  logic        ask_root;                  // there is none: `parent` is the root
  logic [31:0] rank;                      // of `parent`
  logic [27:0] link;                      // address of its node, in nodes
  logic [31:0] grand_parent;
  assign grand_parent = (parent & ~low) | {low[30:0], 1'b0};

  logic marked, essential, arrive, complete, climbs, at_root, from_leaf, send;
  logic [5:0] pause;

  assign marked    = ans_word[parent[4:0]];
  assign essential = state == Mark && marked;
  assign ans_ready = state == Mark && (!marked || wr_ready);
  assign arrive    = ans_valid && ans_ready;
  assign complete  = !essential || upper;  // it climbs on, itself or its parent
  assign from_leaf = state == NextLeaf || (state == Mark && !complete);
  assign next_take = next_valid && (state == NextLeaf || (arrive && !complete));
  assign climbs    = next_take || (arrive && complete);
  assign at_root   = from_leaf ? depth == 5'd0 : ask_root;

  // A request in the same cycle; or later, out of the registers.
  assign send      = STEP_CYCLES == 1 ? climbs && !at_root : 1'b0;
  assign req_valid = send || (state == Climb && pause == '0);
  assign req_addr  = from_leaf ? next_addr : ask_addr;
  assign req_write = 1'b0;
  assign req_word  = '0;

  assign wr_valid = essential && ans_valid;
  assign wr_addr  = {link, 1'b0, upper, 2'b00};
  assign wr_bytes = 7'd4;
  assign wr_data  = {child, child};

  always_ff @(posedge clk) begin
    if (climbs && from_leaf) begin
      leaf   <= next_leaf;
      previous <= next_leaf - 1'b1;
      child  <= next_leaf | ft_pkg::DeviceLeaf;
    end else if (arrive && essential && upper) begin
      child  <= rank;
      previous <= opened;
    end
    if (arrive && essential && !upper) before_open[level] <= previous;

    // Where it goes next is where it looks, or will.
    if (climbs) begin
      parent <= from_leaf ? {next_code[30:1], 2'b10} : ask_parent;
      low    <= from_leaf ? 32'd2 : {low[30:0], 1'b0};
      level  <= from_leaf ? 5'd1 : level + 1'b1;
      upper  <= from_leaf ? next_code[0] : above[0];
      above  <= from_leaf ? next_code[30:1] : {1'b0, above[29:1]};
    end
    if (state == Look) begin
      ask_parent <= grand_parent;
      ask_addr   <= marks + {3'b000, grand_parent[31:5], 2'b00};
      ask_root   <= level == depth;
      rank       <= upper ? previous : leaf;
      link       <= nodes[31:4] + (upper ? previous[27:0] : leaf[27:0]);
      opened     <= before_open[level];
    end else if (next_take) begin
      ask_addr <= next_addr;
    end

    pause <= climbs ? FirstPause : pause - 6'(pause != '0);
    if (start) root <= ft_pkg::DeviceLeaf;
    else if (climbs && at_root) begin
      root <= from_leaf ? next_leaf | ft_pkg::DeviceLeaf : essential ? rank : child;
    end
    if (start) steps <= '0;
    else if (req_valid && req_ready) steps <= steps + 1'b1;

    if (rst || start) state <= NextLeaf;
    else if (req_valid && req_ready) state <= Look;
    else if (climbs && !at_root) state <= Climb;
    else if (state == Look) state <= Mark;
    else if (arrive) state <= NextLeaf;
  end

  assign done = state == NextLeaf && left == '0 && !next_valid;

  always_comb begin
    activity = ft_pkg::Busy;
    case (state)
      NextLeaf: if (!next_valid) activity = done ? ft_pkg::Idle : ft_pkg::Stalled;
      Climb:    if (req_valid && !req_ready) activity = ft_pkg::Stalled + 4'd2;
      Look:     activity = ft_pkg::Stalled + 4'd2;
      Mark:     if (!arrive) activity = ft_pkg::Stalled + (ans_valid ? 4'd1 : 4'd2);
    endcase
  end

`ifndef SYNTHESIS
  always_ff @(posedge clk) begin
    if (!rst) begin
      assert (!start || done) else $error("ft_path_compression: started at work");
      assert (!start || (nodes[3:0] == '0 && marks[1:0] == '0))
      else $error("ft_path_compression: bases that are not aligned");
      assert (!ans_valid || state == Mark)
      else $error("ft_path_compression: an answer to no question, or too soon");
      assert (!fetch || (code >> depth) == '0)
      else $error("ft_path_compression: a code of more bits than the depth");
    end
  end
`endif
endmodule
