// SPDX-License-Identifier: Apache-2.0
// Global control: takes an order through the six steps, one after the other, and ends a build that
// cannot go on. A step is over when its units are done and everything they wrote is in memory.
module ft_control (
    input logic clk,
    input logic rst,

    input  logic           start,
    input  logic           cancel,
    input  logic           flush,
    input  ft_pkg::order_t order,
    output logic           finished,
    output ft_pkg::state_t state,
    output logic           unit_rst,  // to all units: forget what you do

    // The stream that all steps read by.
    output logic        stream_start,
    output logic [31:0] stream_addr,
    output logic [31:0] stream_bytes,
    input  logic        stream_done,

    // One pulse a step, with what the step needs; dones are levels.
    output logic        bounds_start,
    input  logic        bounds_done,
    output logic        setup_start,
    input  logic        setup_done,
    output logic        codes_start,
    input  logic        codes_done,
    output logic        sort_start,
    output logic [3:0]  sort_round,
    output logic        sort_last,
    output logic [31:0] sort_to,
    input  logic        sort_done,
    output logic        leaves_start,
    input  logic        leaves_done,
    output logic        clear_start,
    output logic        nodes_start,
    input  logic        nodes_done,  // INGU, split plane, BEU and cache; BEU alone while it clears
    output logic        climb_start,
    input  logic        climb_done,
    output logic        flush_start,
    input  logic        flush_done,

    // The bus: nothing queued or under way; something has moved in this cycle.
    output logic        bus_abort,
    output logic        bus_clear,
    input  logic        bus_quiet,
    input  logic        bus_moved,
    input  logic        bus_error,
    input  logic [4:0]  bus_error_id,  // write, and its ID
    input  logic        bus_stray,
    input  logic [31:0] bus_stray_addr,

    // What units have found.
    input logic         not_finite,
    input logic [31:0]  not_finite_word,
    input logic         too_many_references,
    input logic         too_many_leaves,
    input logic [31:0]  references,
    input logic [31:0]  leaves,
    input logic [31:0]  root,
    input logic [95:0]  lower,
    input logic [95:0]  upper,
    input ft_pkg::grid_t grid,
    input logic [31:0]  read_beats,
    input logic [31:0]  write_beats,
    input logic [31:0]  climb_steps,
    input logic [159:0] mark_statistics  // reads, read hits, writes, write hits, write backs
);
  typedef enum logic [3:0] {
    Rest,
    Check,
    Bounds,
    Setup,
    Codes,
    Sort,
    Leaves,
    Clear,
    Nodes,
    Climb,
    Flush,
    Abort
  } phase_t;

  phase_t phase;
  logic launch;  // the phase's first cycle
  logic over;    // its last
  logic build_start;
  logic [3:0] round;
  logic odd_round;
  logic done, failed;
  logic [7:0] error, found;
  logic [31:0] detail, found_detail;
  logic [3:0] stage;
  logic [63:0] cycles;
  logic [191:0] stage_cycles;
  logic [31:0] still;  // cycles in which nothing has moved
  logic timeout, busy, building;

  // ---- What is wrong with an order, before anything is touched. An order stands in its registers
  // for two cycles before its start (ft_registers answers one write before it takes the next), so
  // what follows from it may come that much later.
  logic [37:0] scene_needs;
  logic [31:0] scene_bytes;
  logic [31:0] marks_need;
  logic [31:0] bad_word, wrong_word;
  logic [3:0]  last_round;
  logic order_bad, order_wrong, scene_large;

  assign scene_needs = {order.triangles, 5'd0} + {3'd0, order.triangles, 2'd0} + 38'd0;

  always_comb begin
    order_bad = 1'b1;
    bad_word  = 32'd0;
    if (order.shape[4:0] > 5'd30 || order.shape[31:9] != '0 || order.shape[7:5] != '0) bad_word = 32'd1;
    else if (order.scene[11:0] != '0) bad_word = 32'd3;
    else if (order.pairs0[11:0] != '0) bad_word = 32'd4;
    else if (order.pairs1[11:0] != '0) bad_word = 32'd5;
    else if (order.sorted_codes[11:0] != '0) bad_word = 32'd6;
    else if (order.sorted_ids[11:0] != '0) bad_word = 32'd7;
    else if (order.leaf_codes[11:0] != '0) bad_word = 32'd8;
    else if (order.leaf_rows[11:0] != '0) bad_word = 32'd9;
    else if (order.marks[11:0] != '0) bad_word = 32'd10;
    else if (order.nodes[11:0] != '0) bad_word = 32'd11;
    else if (order.reference_capacity[31:29] != '0) bad_word = 32'd12;
    else if (order.leaf_capacity == '0 || order.leaf_capacity[31:28] != '0) bad_word = 32'd13;
    else if (order.mark_bytes < marks_need || order.mark_bytes[1:0] != '0) bad_word = 32'd14;
    else if (order.rounds == '0 || order.rounds > 32'd8 || {order.rounds[3:0], 2'd0} < {1'b0, order.shape[4:0]})
      bad_word = 32'd15;
    else if (order.window_begin[5:0] != '0) bad_word = 32'd16;
    else if (order.window_end[5:0] != '0) bad_word = 32'd17;
    else order_bad = 1'b0;
  end

  always_ff @(posedge clk) begin
    marks_need  <= order.shape[4:0] < 5'd8 ? 32'd64 : 32'd1 << (order.shape[4:0] - 5'd2);
    order_wrong <= order_bad;
    wrong_word  <= bad_word;
    scene_large <= scene_needs > {6'd0, order.scene_bytes};
    scene_bytes <= scene_needs[31:0];
    last_round  <= order.rounds[3:0] - 1'b1;
    // A launch begins the count anew.
    timeout     <= !launch && order.watchdog != '0 && still >= order.watchdog;
  end

  // ---- What has gone wrong; the first of these that holds. What a unit says of the build before it
  // forgets with its start.
  always_comb begin
    found        = ft_pkg::ErrorNone;
    found_detail = 32'd0;
    if (cancel) found = ft_pkg::ErrorCancelled;
    else if (phase == Check && order_wrong) begin
      found        = ft_pkg::ErrorOrder;
      found_detail = wrong_word;
    end else if (phase == Check && scene_large) begin
      found        = ft_pkg::ErrorScene;
      found_detail = order.scene_bytes;
    end else if (bus_error) begin
      found        = ft_pkg::ErrorMemory;
      found_detail = 32'(bus_error_id);
    end else if (bus_stray) begin
      found        = ft_pkg::ErrorWindow;
      found_detail = bus_stray_addr;
    end else if (not_finite && phase == Bounds && !launch) begin
      found        = ft_pkg::ErrorNotFinite;
      found_detail = not_finite_word;
    end else if (too_many_references && phase == Codes && !launch) begin
      found        = ft_pkg::ErrorReferences;
      found_detail = order.reference_capacity;
    end else if (too_many_leaves && phase == Leaves && !launch) begin
      found        = ft_pkg::ErrorLeaves;
      found_detail = order.leaf_capacity;
    end else if (timeout) found = ft_pkg::ErrorTimeout;
  end

  // ---- The steps.
  assign building    = phase != Rest && phase != Abort && phase != Flush;
  assign busy        = phase != Rest;
  assign build_start = phase == Rest && start;

  always_comb begin
    over = 1'b0;
    case (phase)
      Check: over = 1'b1;
      Bounds: over = !launch && bounds_done && stream_done && bus_quiet;
      Setup: over = !launch && setup_done;
      Codes: over = !launch && codes_done && stream_done && bus_quiet;
      Sort: over = !launch && sort_done && stream_done && bus_quiet;
      Leaves: over = !launch && leaves_done && stream_done && bus_quiet;
      Clear, Nodes: over = !launch && nodes_done && stream_done && bus_quiet;
      Climb: over = !launch && climb_done && stream_done && bus_quiet;
      Flush: over = !launch && flush_done && bus_quiet;
      Abort: over = !launch && (bus_quiet || timeout);
      default: over = 1'b0;
    endcase
  end

  always_ff @(posedge clk) begin
    finished <= 1'b0;
    unit_rst <= 1'b0;
    if (rst) begin
      phase    <= Rest;
      launch   <= 1'b0;
      unit_rst <= 1'b1;
    end else if (phase == Rest) begin
      round <= '0;
      if (start) begin
        phase    <= Check;
        unit_rst <= 1'b1;
      end else if (flush) begin
        phase  <= Flush;
        launch <= 1'b1;
      end
    end else if (building && found != ft_pkg::ErrorNone) begin
      phase  <= Abort;
      launch <= 1'b1;
    end else if (over) begin
      launch <= 1'b1;
      case (phase)
        Check: phase <= Bounds;
        Bounds: phase <= Setup;
        Setup: phase <= Codes;
        Codes: phase <= Sort;
        Sort: begin
          if (sort_last) phase <= Leaves;
          else round <= round + 1'b1;
        end
        Leaves: phase <= Clear;
        Clear: phase <= Nodes;
        Nodes: phase <= Climb;
        default: begin
          phase    <= Rest;
          launch   <= 1'b0;
          finished <= phase != Flush;
          unit_rst <= phase == Abort;
        end
      endcase
    end else begin
      launch <= 1'b0;
    end
  end

  assign bounds_start = launch && phase == Bounds;
  assign setup_start  = launch && phase == Setup;
  assign codes_start  = launch && phase == Codes;
  assign sort_start   = launch && phase == Sort;
  assign leaves_start = launch && phase == Leaves;
  assign clear_start  = launch && phase == Clear;
  assign nodes_start  = launch && phase == Nodes;
  assign climb_start  = launch && phase == Climb;
  assign flush_start  = launch && phase == Flush;
  assign bus_abort    = phase == Abort;
  assign bus_clear    = build_start;

  assign sort_round = round;
  assign sort_last  = round == last_round;
  assign odd_round  = round[0];
  assign sort_to    = sort_last ? order.sorted_codes : odd_round ? order.pairs0 : order.pairs1;

  always_comb begin
    stream_start = launch;
    stream_addr  = order.scene;
    stream_bytes = scene_bytes;
    case (phase)
      Bounds, Codes: begin
      end
      Sort: begin
        stream_addr  = odd_round ? order.pairs1 : order.pairs0;
        stream_bytes = {references[28:0], 3'd0};
      end
      Leaves: begin
        stream_addr  = order.sorted_codes;
        stream_bytes = {references[29:0], 2'd0};
      end
      Nodes, Climb: begin
        stream_addr  = order.leaf_codes;
        stream_bytes = {leaves[29:0], 2'd0};
      end
      default: stream_start = 1'b0;
    endcase
  end

  // ---- The account.
  always_comb begin
    case (phase)
      Bounds: stage = ft_pkg::StageSceneBound;
      Setup, Codes: stage = ft_pkg::StageMortonCode;
      Sort: stage = ft_pkg::StageRadixSort;
      Leaves: stage = ft_pkg::StageLeafNode;
      Clear, Nodes: stage = ft_pkg::StageInternalNode;
      Climb: stage = ft_pkg::StagePathCompression;
      default: stage = ft_pkg::StageNone;
    endcase
  end

  always_ff @(posedge clk) begin
    if (rst) begin
      done   <= 1'b0;
      failed <= 1'b0;
      error  <= ft_pkg::ErrorNone;
      detail <= '0;
      cycles <= '0;
      stage_cycles <= '0;
    end else if (build_start) begin
      done   <= 1'b0;
      failed <= 1'b0;
      error  <= ft_pkg::ErrorNone;
      detail <= '0;
      cycles <= '0;
      stage_cycles <= '0;
    end else if (building) begin
      cycles <= cycles + 1'b1;
      for (int s = 0; s < 6; s = s + 1) begin
        if (stage == 4'(s + 1)) stage_cycles[32*s+:32] <= stage_cycles[32*s+:32] + 1'b1;
      end
      if (found != ft_pkg::ErrorNone) begin
        error  <= found;
        detail <= found_detail;
      end else if (over && phase == Climb) begin
        done <= 1'b1;
      end
    end else if (phase == Abort && over) begin
      done   <= 1'b1;
      failed <= 1'b1;
    end
    if (bus_moved || launch || phase == Rest) still <= '0;
    else still <= still + 1'b1;
  end

  always_comb begin
    state.busy   = busy || start;
    state.done   = done;
    state.failed = failed;
    state.stage  = stage;
    state.error  = error;
    state.results.references       = references;
    state.results.leaves           = leaves;
    state.results.root             = root;
    state.results.grid             = {12'd0, grid.bits, 3'd0, grid.depth};
    state.results.lower            = lower;
    state.results.upper            = upper;
    state.results.error_detail     = detail;
    state.results.cycles           = cycles;
    state.results.stage_cycles     = stage_cycles;
    state.results.read_beats       = read_beats;
    state.results.write_beats      = write_beats;
    state.results.climb_steps      = climb_steps;
    state.results.mark_reads       = mark_statistics[31:0];
    state.results.mark_read_hits   = mark_statistics[63:32];
    state.results.mark_writes      = mark_statistics[95:64];
    state.results.mark_write_hits  = mark_statistics[127:96];
    state.results.mark_write_backs = mark_statistics[159:128];
  end
endmodule
