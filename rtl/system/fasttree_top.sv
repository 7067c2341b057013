// SPDX-License-Identifier: Apache-2.0
// The accelerator: an AXI4-Lite slave to order kd-trees by, an AXI4 master to memory, and an
// interrupt. One clock, one synchronous reset. Ports, registers and memory map:
// docs/accelerator/integration.md.
module fasttree_top #(
    parameter int BUS_BYTES = 16,          // of the AXI master's data: 8, 16, 32 or 64
    parameter int MORTON_CODE_UNITS = 4,
    parameter int PREFIX_SUM_UNITS = 4,
    parameter int PREFIX_SUM_SECTION = 32,
    parameter int PREFIX_SUM_STAGES = 2,
    parameter int SCENE_BOUND_INPUTS = 8,
    parameter int LEAF_NODE_WIDTH = 32,
    parameter int MARK_CACHE_BYTES = 16384,
    parameter int MARK_CACHE_WAYS = 16,
    parameter int BUS_DUPLEX = 0,          // reads and writes may cross in one cycle
    parameter int READ_AHEAD_BYTES = 512,
    parameter int WATCHDOG = 1 << 20,      // cycles, until the host orders otherwise
    localparam int Activities = 12 + MORTON_CODE_UNITS + PREFIX_SUM_UNITS
) (
    input logic aclk,
    input logic aresetn,

    input  logic        s_axi_awvalid,
    output logic        s_axi_awready,
    input  logic [11:0] s_axi_awaddr,
    input  logic        s_axi_wvalid,
    output logic        s_axi_wready,
    input  logic [31:0] s_axi_wdata,
    input  logic [3:0]  s_axi_wstrb,
    output logic        s_axi_bvalid,
    input  logic        s_axi_bready,
    output logic [1:0]  s_axi_bresp,
    input  logic        s_axi_arvalid,
    output logic        s_axi_arready,
    input  logic [11:0] s_axi_araddr,
    output logic        s_axi_rvalid,
    input  logic        s_axi_rready,
    output logic [31:0] s_axi_rdata,
    output logic [1:0]  s_axi_rresp,
    output logic        irq,

    output logic [3:0]             m_axi_awid,
    output logic [31:0]            m_axi_awaddr,
    output logic [7:0]             m_axi_awlen,
    output logic [2:0]             m_axi_awsize,
    output logic [1:0]             m_axi_awburst,
    output logic                   m_axi_awlock,
    output logic [3:0]             m_axi_awcache,
    output logic [2:0]             m_axi_awprot,
    output logic [3:0]             m_axi_awqos,
    output logic                   m_axi_awvalid,
    input  logic                   m_axi_awready,
    output logic [8*BUS_BYTES-1:0] m_axi_wdata,
    output logic [BUS_BYTES-1:0]   m_axi_wstrb,
    output logic                   m_axi_wlast,
    output logic                   m_axi_wvalid,
    input  logic                   m_axi_wready,
    input  logic [3:0]             m_axi_bid,
    input  logic [1:0]             m_axi_bresp,
    input  logic                   m_axi_bvalid,
    output logic                   m_axi_bready,
    output logic [3:0]             m_axi_arid,
    output logic [31:0]            m_axi_araddr,
    output logic [7:0]             m_axi_arlen,
    output logic [2:0]             m_axi_arsize,
    output logic [1:0]             m_axi_arburst,
    output logic                   m_axi_arlock,
    output logic [3:0]             m_axi_arcache,
    output logic [2:0]             m_axi_arprot,
    output logic [3:0]             m_axi_arqos,
    output logic                   m_axi_arvalid,
    input  logic                   m_axi_arready,
    input  logic [3:0]             m_axi_rid,
    input  logic [8*BUS_BYTES-1:0] m_axi_rdata,
    input  logic [1:0]             m_axi_rresp,
    input  logic                   m_axi_rlast,
    input  logic                   m_axi_rvalid,
    output logic                   m_axi_rready,

    // To look at while it works; may be left open. Four bits a unit, see ft_pkg: bus, scene reader,
    // SBCUs (lower, upper), MCGUs, pair writer, PSUs, RSU, LNGU, INGU, split plane, BEU, cache, PCU.
    output logic [3:0]              stage,
    output logic [4*Activities-1:0] activity
);
  // What each unit does, in the order of `activity`.
  localparam int AtCodes = 4;
  localparam int AtPairs = AtCodes + MORTON_CODE_UNITS;
  localparam int AtSums = AtPairs + 1;
  localparam int AtSort = AtSums + PREFIX_SUM_UNITS;

  logic rst, unit_rst, quiet_rst;
  ft_pkg::order_t order;
  ft_pkg::state_t state;
  ft_pkg::grid_t grid;
  logic start, cancel, flush, finished;

  always_ff @(posedge aclk) rst <= !aresetn;
  assign quiet_rst = rst || unit_rst;
  assign stage = state.stage;

  ft_registers #(
      .CAPABILITIES({8'(PREFIX_SUM_SECTION), 8'(PREFIX_SUM_UNITS), 8'(MORTON_CODE_UNITS), 8'(BUS_BYTES)}),
      .WATCHDOG(WATCHDOG)
  ) registers (
      .clk(aclk),
      .rst(rst),
      .s_axi_awvalid(s_axi_awvalid),
      .s_axi_awready(s_axi_awready),
      .s_axi_awaddr(s_axi_awaddr),
      .s_axi_wvalid(s_axi_wvalid),
      .s_axi_wready(s_axi_wready),
      .s_axi_wdata(s_axi_wdata),
      .s_axi_wstrb(s_axi_wstrb),
      .s_axi_bvalid(s_axi_bvalid),
      .s_axi_bready(s_axi_bready),
      .s_axi_bresp(s_axi_bresp),
      .s_axi_arvalid(s_axi_arvalid),
      .s_axi_arready(s_axi_arready),
      .s_axi_araddr(s_axi_araddr),
      .s_axi_rvalid(s_axi_rvalid),
      .s_axi_rready(s_axi_rready),
      .s_axi_rdata(s_axi_rdata),
      .s_axi_rresp(s_axi_rresp),
      .irq(irq),
      .start(start),
      .cancel(cancel),
      .flush(flush),
      .order(order),
      .finished(finished),
      .state(state)
  );

  // ---- Control.
  logic stream_start, stream_done;
  logic [31:0] stream_addr, stream_bytes;
  logic bounds_start, bounds_done, setup_start, setup_done, codes_start, codes_done;
  logic sort_start, sort_last, sort_done, leaves_start, leaves_done, clear_start, nodes_start, nodes_done;
  logic climb_start, climb_done, flush_start, flush_done;
  logic [3:0] sort_round;
  logic [31:0] sort_to;
  logic bus_abort, bus_clear, bus_quiet, bus_moved, bus_error, bus_stray;
  logic [31:0] bus_stray_addr, bad_word, references, leaves, root, read_beats, write_beats, climb_steps;
  logic [4:0] bus_error_id;
  logic bad, references_overflow, leaves_overflow;
  logic [95:0] lower, upper;
  logic [159:0] mark_statistics;

  ft_control control (
      .clk(aclk),
      .rst(rst),
      .start(start),
      .cancel(cancel),
      .flush(flush),
      .order(order),
      .finished(finished),
      .state(state),
      .unit_rst(unit_rst),
      .stream_start(stream_start),
      .stream_addr(stream_addr),
      .stream_bytes(stream_bytes),
      .stream_done(stream_done),
      .bounds_start(bounds_start),
      .bounds_done(bounds_done),
      .setup_start(setup_start),
      .setup_done(setup_done),
      .codes_start(codes_start),
      .codes_done(codes_done),
      .sort_start(sort_start),
      .sort_round(sort_round),
      .sort_last(sort_last),
      .sort_to(sort_to),
      .sort_done(sort_done),
      .leaves_start(leaves_start),
      .leaves_done(leaves_done),
      .clear_start(clear_start),
      .nodes_start(nodes_start),
      .nodes_done(nodes_done),
      .climb_start(climb_start),
      .climb_done(climb_done),
      .flush_start(flush_start),
      .flush_done(flush_done),
      .bus_abort(bus_abort),
      .bus_clear(bus_clear),
      .bus_quiet(bus_quiet),
      .bus_moved(bus_moved),
      .bus_error(bus_error),
      .bus_error_id(bus_error_id),
      .bus_stray(bus_stray),
      .bus_stray_addr(bus_stray_addr),
      .not_finite(bad),
      .not_finite_word(bad_word),
      .too_many_references(references_overflow),
      .too_many_leaves(leaves_overflow),
      .references(references),
      .leaves(leaves),
      .root(root),
      .lower(lower),
      .upper(upper),
      .grid(grid),
      .read_beats(read_beats),
      .write_beats(write_beats),
      .climb_steps(climb_steps),
      .mark_statistics(mark_statistics)
  );

  assign bus_moved = (m_axi_awvalid && m_axi_awready) || (m_axi_wvalid && m_axi_wready) ||
                     (m_axi_bvalid && m_axi_bready) || (m_axi_arvalid && m_axi_arready) ||
                     (m_axi_rvalid && m_axi_rready);

  // ---- The bus. Its stream goes to the unit of the stage.
  localparam int Writers = 8;
  localparam int ToPairs = 0;
  localparam int ToSorted = 1;
  localparam int ToLeafCodes = 2;
  localparam int ToLeafRows = 3;
  localparam int ToNodes = 4;
  localparam int ToClear = 5;
  localparam int ToCache = 6;
  localparam int ToLinks = 7;

  logic rd_valid, rd_ready, rdq_valid, rdq_ready, rdd_valid, rdd_ready;
  logic [8*BUS_BYTES-1:0] rd_data;
  logic [31:0] rdq_addr;
  logic [63:0] rdd_data;
  logic [Writers-1:0] wr_valid, wr_ready;
  logic [32*Writers-1:0] wr_addr;
  logic [7*Writers-1:0] wr_bytes;
  logic [512*Writers-1:0] wr_data;
  logic scene_rd_ready, sort_rd_ready, leaf_rd_ready, node_rd_ready, climb_rd_ready;
  logic scene_stage, sort_stage, leaf_stage, node_stage, climb_stage;

  assign scene_stage = stage == ft_pkg::StageSceneBound || stage == ft_pkg::StageMortonCode;
  assign sort_stage  = stage == ft_pkg::StageRadixSort;
  assign leaf_stage  = stage == ft_pkg::StageLeafNode;
  assign node_stage  = stage == ft_pkg::StageInternalNode;
  assign climb_stage = stage == ft_pkg::StagePathCompression;
  assign rd_ready    = (scene_stage && scene_rd_ready) || (sort_stage && sort_rd_ready) ||
                       (leaf_stage && leaf_rd_ready) || (node_stage && node_rd_ready) ||
                       (climb_stage && climb_rd_ready);

  ft_bus #(
      .BUS_BYTES(BUS_BYTES),
      .WRITERS(Writers),
      .READ_AHEAD(READ_AHEAD_BYTES),
      .DUPLEX(BUS_DUPLEX)
  ) bus (
      .clk(aclk),
      .rst(quiet_rst),
      .cancel(bus_abort),
      .clear(bus_clear),
      .window_begin(order.window_begin),
      .window_end(order.window_end),
      .quiet(bus_quiet),
      .activity(activity[3:0]),
      .stray(bus_stray),
      .stray_addr(bus_stray_addr),
      .axi_error(bus_error),
      .axi_error_id(bus_error_id),
      .read_beats(read_beats),
      .write_beats(write_beats),
      .stream_start(stream_start),
      .stream_addr(stream_addr),
      .stream_bytes(stream_bytes),
      .stream_done(stream_done),
      .rd_valid(rd_valid),
      .rd_ready(rd_ready),
      .rd_data(rd_data),
      .rdq_valid(rdq_valid),
      .rdq_ready(rdq_ready),
      .rdq_addr(rdq_addr),
      .rdd_valid(rdd_valid),
      .rdd_ready(rdd_ready),
      .rdd_data(rdd_data),
      .wr_valid(wr_valid),
      .wr_ready(wr_ready),
      .wr_addr(wr_addr),
      .wr_bytes(wr_bytes),
      .wr_data(wr_data),
      .m_axi_awid(m_axi_awid),
      .m_axi_awaddr(m_axi_awaddr),
      .m_axi_awlen(m_axi_awlen),
      .m_axi_awsize(m_axi_awsize),
      .m_axi_awburst(m_axi_awburst),
      .m_axi_awlock(m_axi_awlock),
      .m_axi_awcache(m_axi_awcache),
      .m_axi_awprot(m_axi_awprot),
      .m_axi_awqos(m_axi_awqos),
      .m_axi_awvalid(m_axi_awvalid),
      .m_axi_awready(m_axi_awready),
      .m_axi_wdata(m_axi_wdata),
      .m_axi_wstrb(m_axi_wstrb),
      .m_axi_wlast(m_axi_wlast),
      .m_axi_wvalid(m_axi_wvalid),
      .m_axi_wready(m_axi_wready),
      .m_axi_bid(m_axi_bid),
      .m_axi_bresp(m_axi_bresp),
      .m_axi_bvalid(m_axi_bvalid),
      .m_axi_bready(m_axi_bready),
      .m_axi_arid(m_axi_arid),
      .m_axi_araddr(m_axi_araddr),
      .m_axi_arlen(m_axi_arlen),
      .m_axi_arsize(m_axi_arsize),
      .m_axi_arburst(m_axi_arburst),
      .m_axi_arlock(m_axi_arlock),
      .m_axi_arcache(m_axi_arcache),
      .m_axi_arprot(m_axi_arprot),
      .m_axi_arqos(m_axi_arqos),
      .m_axi_arvalid(m_axi_arvalid),
      .m_axi_arready(m_axi_arready),
      .m_axi_rid(m_axi_rid),
      .m_axi_rdata(m_axi_rdata),
      .m_axi_rresp(m_axi_rresp),
      .m_axi_rlast(m_axi_rlast),
      .m_axi_rvalid(m_axi_rvalid),
      .m_axi_rready(m_axi_rready)
  );

  // ---- Step 1: the scene's bounds.
  logic group_valid, group_ready, lower_ready, upper_ready, scene_done, lower_done, upper_done;
  logic [1:0] group_axis;
  logic [32*SCENE_BOUND_INPUTS-1:0] group_values;
  logic [MORTON_CODE_UNITS-1:0] tri_valid, tri_ready;
  logic [31:0] tri_id;
  logic [287:0] tri_coords;

  ft_scene_reader #(
      .BUS_BYTES(BUS_BYTES),
      .INPUTS(SCENE_BOUND_INPUTS),
      .UNITS(MORTON_CODE_UNITS)
  ) scene_reader (
      .clk(aclk),
      .rst(quiet_rst),
      .start_bounds(bounds_start),
      .start_triangles(codes_start),
      .triangles(order.triangles),
      .rd_valid(rd_valid && scene_stage),
      .rd_ready(scene_rd_ready),
      .rd_data(rd_data),
      .group_valid(group_valid),
      .group_ready(group_ready),
      .group_axis(group_axis),
      .group_values(group_values),
      .tri_valid(tri_valid),
      .tri_ready(tri_ready),
      .tri_id(tri_id),
      .tri_coords(tri_coords),
      .bad(bad),
      .bad_word(bad_word),
      .done(scene_done),
      .activity(activity[7:4])
  );

  // Both take a group in the same cycle.
  assign group_ready = lower_ready && upper_ready;
  ft_scene_bound #(
      .UPPER(1'b0),
      .INPUTS(SCENE_BOUND_INPUTS)
  ) scene_bound_lower (
      .clk(aclk),
      .rst(quiet_rst),
      .start(bounds_start),
      .in_valid(group_valid && group_ready),
      .in_ready(lower_ready),
      .in_axis(group_axis),
      .in_values(group_values),
      .bound(lower),
      .done(lower_done),
      .activity(activity[11:8])
  );
  ft_scene_bound #(
      .UPPER(1'b1),
      .INPUTS(SCENE_BOUND_INPUTS)
  ) scene_bound_upper (
      .clk(aclk),
      .rst(quiet_rst),
      .start(bounds_start),
      .in_valid(group_valid && group_ready),
      .in_ready(upper_ready),
      .in_axis(group_axis),
      .in_values(group_values),
      .bound(upper),
      .done(upper_done),
      .activity(activity[15:12])
  );
  assign bounds_done = scene_done && lower_done && upper_done;

  // ---- Step 2: the grid, then codes.
  ft_grid_setup grid_setup (
      .clk(aclk),
      .rst(quiet_rst),
      .start(setup_start),
      .lo(lower),
      .hi(upper),
      .longest(order.shape[8]),
      .depth_asked(order.shape[4:0]),
      .grid(grid),
      .done(setup_done)
  );

  logic [MORTON_CODE_UNITS-1:0] mcgu_done;
  logic [2*MORTON_CODE_UNITS-1:0] pair_count, pair_take;
  logic [65*MORTON_CODE_UNITS-1:0] pair0, pair1;
  logic [511:0] digit_counts;
  logic writer_done;

  for (genvar u = 0; u < MORTON_CODE_UNITS; u = u + 1) begin : g_morton_code
    ft_morton_code unit (
        .clk(aclk),
        .rst(quiet_rst),
        .grid(grid),
        .tri_valid(tri_valid[u]),
        .tri_ready(tri_ready[u]),
        .tri_id(tri_id),
        .tri_coords(tri_coords),
        .pair_count(pair_count[2*u+:2]),
        .pair0(pair0[65*u+:65]),
        .pair1(pair1[65*u+:65]),
        .pair_take(pair_take[2*u+:2]),
        .done(mcgu_done[u]),
        .activity(activity[4*(AtCodes+u)+:4])
    );
  end
  ft_pair_writer #(
      .UNITS(MORTON_CODE_UNITS)
  ) pair_writer (
      .clk(aclk),
      .rst(quiet_rst),
      .start(codes_start),
      .addr(order.pairs0),
      .triangles(order.triangles),
      .capacity(order.reference_capacity),
      .pair_count(pair_count),
      .pair0(pair0),
      .pair1(pair1),
      .pair_take(pair_take),
      .wr_valid(wr_valid[ToPairs]),
      .wr_ready(wr_ready[ToPairs]),
      .wr_addr(wr_addr[32*ToPairs+:32]),
      .wr_bytes(wr_bytes[7*ToPairs+:7]),
      .wr_data(wr_data[512*ToPairs+:256]),
      .written(references),
      .counts(digit_counts),
      .overflow(references_overflow),
      .done(writer_done),
      .activity(activity[4*AtPairs+:4])
  );
  assign wr_data[512*ToPairs+256+:256] = '0;
  assign codes_done = scene_done && &mcgu_done && writer_done;


  // ---- Step 3: the sort.
  logic sorter_done;
  ft_sorter #(
      .BUS_BYTES(BUS_BYTES),
      .UNITS(PREFIX_SUM_UNITS),
      .SECTION(PREFIX_SUM_SECTION),
      .STAGES(PREFIX_SUM_STAGES)
  ) sorter (
      .clk(aclk),
      .rst(quiet_rst),
      .start(sort_start),
      .round(sort_round),
      .last(sort_last),
      .pairs(references),
      .to(sort_to),
      .to_ids(order.sorted_ids),
      .use_counts_in(sort_round == '0),
      .counts_in(digit_counts),
      .rd_valid(rd_valid && sort_stage),
      .rd_ready(sort_rd_ready),
      .rd_data(rd_data),
      .wr_valid(wr_valid[ToSorted]),
      .wr_ready(wr_ready[ToSorted]),
      .wr_addr(wr_addr[32*ToSorted+:32]),
      .wr_bytes(wr_bytes[7*ToSorted+:7]),
      .wr_data(wr_data[512*ToSorted+:256]),
      .done(sorter_done),
      .activity(activity[4*AtSort+:4]),
      .psu_activity(activity[4*AtSums+:4*PREFIX_SUM_UNITS])
  );
  assign wr_data[512*ToSorted+256+:256] = '0;
  assign sort_done = sorter_done;

  // ---- Step 4: leaves.
  ft_leaf_node #(
      .BUS_BYTES(BUS_BYTES),
      .WIDTH(LEAF_NODE_WIDTH)
  ) leaf_node (
      .clk(aclk),
      .rst(quiet_rst),
      .start(leaves_start),
      .references(references),
      .leaf_codes(order.leaf_codes),
      .leaf_rows(order.leaf_rows),
      .leaf_capacity(order.leaf_capacity),
      .rd_valid(rd_valid && leaf_stage),
      .rd_ready(leaf_rd_ready),
      .rd_data(rd_data),
      .wr_code_valid(wr_valid[ToLeafCodes]),
      .wr_code_ready(wr_ready[ToLeafCodes]),
      .wr_code_addr(wr_addr[32*ToLeafCodes+:32]),
      .wr_code_bytes(wr_bytes[7*ToLeafCodes+:7]),
      .wr_code_data(wr_data[512*ToLeafCodes+:512]),
      .wr_row_valid(wr_valid[ToLeafRows]),
      .wr_row_ready(wr_ready[ToLeafRows]),
      .wr_row_addr(wr_addr[32*ToLeafRows+:32]),
      .wr_row_bytes(wr_bytes[7*ToLeafRows+:7]),
      .wr_row_data(wr_data[512*ToLeafRows+:512]),
      .leaves(leaves),
      .overflow(leaves_overflow),
      .done(leaves_done),
      .activity(activity[4*(AtSort+1)+:4])
  );

  // ---- Step 5: internal nodes, their planes and their marks.
  logic node_valid, node_ready, mark_valid, mark_ready, ingu_done, plane_done, beu_done, cache_done;
  logic [31:0] node_code, mark_index, nodes_count;
  logic [4:0] node_bit;
  logic beu_req_valid, beu_req_write, pcu_req_valid, pcu_req_write, req_ready, ans_valid, ans_ready;
  logic [31:0] beu_req_addr, beu_req_word, pcu_req_addr, pcu_req_word, ans_word;

  assign nodes_count = leaves == '0 ? 32'd0 : leaves - 32'd1;
  assign nodes_done  = ingu_done && plane_done && beu_done && cache_done;

  ft_internal_node #(
      .BUS_BYTES(BUS_BYTES)
  ) internal_node (
      .clk(aclk),
      .rst(quiet_rst),
      .start(nodes_start),
      .leaves(leaves),
      .rd_valid(rd_valid && node_stage),
      .rd_ready(node_rd_ready),
      .rd_data(rd_data),
      .node_valid(node_valid),
      .node_ready(node_ready),
      .node_code(node_code),
      .node_bit(node_bit),
      .mark_valid(mark_valid),
      .mark_ready(mark_ready),
      .mark_index(mark_index),
      .done(ingu_done),
      .activity(activity[4*(AtSort+2)+:4])
  );
  ft_split_plane split_plane (
      .clk(aclk),
      .rst(quiet_rst),
      .start(nodes_start),
      .count(nodes_count),
      .nodes(order.nodes),
      .grid(grid),
      .node_valid(node_valid),
      .node_ready(node_ready),
      .node_code(node_code),
      .node_bit(node_bit),
      .wr_valid(wr_valid[ToNodes]),
      .wr_ready(wr_ready[ToNodes]),
      .wr_addr(wr_addr[32*ToNodes+:32]),
      .wr_bytes(wr_bytes[7*ToNodes+:7]),
      .wr_data(wr_data[512*ToNodes+:512]),
      .done(plane_done),
      .activity(activity[4*(AtSort+3)+:4])
  );
  ft_bit_encoding bit_encoding (
      .clk(aclk),
      .rst(quiet_rst),
      .start_clear(clear_start),
      .start_marks(nodes_start),
      .marks(order.marks),
      .mark_bytes(order.mark_bytes),
      .nodes(nodes_count),
      .mark_valid(mark_valid),
      .mark_ready(mark_ready),
      .mark_index(mark_index),
      .wr_valid(wr_valid[ToClear]),
      .wr_ready(wr_ready[ToClear]),
      .wr_addr(wr_addr[32*ToClear+:32]),
      .wr_bytes(wr_bytes[7*ToClear+:7]),
      .wr_data(wr_data[512*ToClear+:512]),
      .req_valid(beu_req_valid),
      .req_ready(req_ready),
      .req_addr(beu_req_addr),
      .req_write(beu_req_write),
      .req_word(beu_req_word),
      .done(beu_done),
      .activity(activity[4*(AtSort+4)+:4])
  );
  // The BEU asks in step 5, the PCU in step 6.
  ft_mark_cache #(
      .BYTES(MARK_CACHE_BYTES),
      .WAYS(MARK_CACHE_WAYS)
  ) mark_cache (
      .clk(aclk),
      .rst(quiet_rst),
      .clear(1'b0),  // each build begins with a reset of all units
      .flush(flush_start),
      .req_valid(beu_req_valid || pcu_req_valid),
      .req_ready(req_ready),
      .req_addr(climb_stage ? pcu_req_addr : beu_req_addr),
      .req_write(climb_stage ? pcu_req_write : beu_req_write),
      .req_word(climb_stage ? pcu_req_word : beu_req_word),
      .ans_valid(ans_valid),
      .ans_ready(ans_ready),
      .ans_word(ans_word),
      .wr_valid(wr_valid[ToCache]),
      .wr_ready(wr_ready[ToCache]),
      .wr_addr(wr_addr[32*ToCache+:32]),
      .wr_bytes(wr_bytes[7*ToCache+:7]),
      .wr_data(wr_data[512*ToCache+:64]),
      .rdq_valid(rdq_valid),
      .rdq_ready(rdq_ready),
      .rdq_addr(rdq_addr),
      .rdd_valid(rdd_valid),
      .rdd_ready(rdd_ready),
      .rdd_data(rdd_data),
      .reads(mark_statistics[31:0]),
      .read_hits(mark_statistics[63:32]),
      .writes(mark_statistics[95:64]),
      .write_hits(mark_statistics[127:96]),
      .write_backs(mark_statistics[159:128]),
      .done(cache_done),
      .activity(activity[4*(AtSort+5)+:4])
  );
  assign wr_data[512*ToCache+64+:448] = '0;
  assign flush_done = cache_done;

  // ---- Step 6: links.
  logic pcu_done;
  ft_path_compression #(
      .BUS_BYTES(BUS_BYTES)
  ) path_compression (
      .clk(aclk),
      .rst(quiet_rst),
      .start(climb_start),
      .leaves(leaves),
      .depth(grid.depth),
      .marks(order.marks),
      .nodes(order.nodes),
      .rd_valid(rd_valid && climb_stage),
      .rd_ready(climb_rd_ready),
      .rd_data(rd_data),
      .req_valid(pcu_req_valid),
      .req_ready(req_ready),
      .req_addr(pcu_req_addr),
      .req_write(pcu_req_write),
      .req_word(pcu_req_word),
      .ans_valid(ans_valid),
      .ans_ready(ans_ready),
      .ans_word(ans_word),
      .wr_valid(wr_valid[ToLinks]),
      .wr_ready(wr_ready[ToLinks]),
      .wr_addr(wr_addr[32*ToLinks+:32]),
      .wr_bytes(wr_bytes[7*ToLinks+:7]),
      .wr_data(wr_data[512*ToLinks+:64]),
      .root(root),
      .steps(climb_steps),
      .done(pcu_done),
      .activity(activity[4*(AtSort+6)+:4])
  );
  assign wr_data[512*ToLinks+64+:448] = '0;
  assign climb_done = pcu_done && cache_done;

endmodule
