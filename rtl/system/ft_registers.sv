// SPDX-License-Identifier: Apache-2.0
// The registers behind an AXI4-Lite slave: what the host orders, how the build goes, what it found.
// The map is in docs/accelerator/integration.md and, for drivers, in rtl/driver/fasttree_accel.h.
// One transaction of each direction at a time; unknown addresses read as zero and ignore writes, and
// so does the order during a build: the units read it from here.
module ft_registers #(
    parameter logic [31:0] CAPABILITIES = 32'd0,
    parameter int WATCHDOG = 1 << 20  // cycles in which nothing moves before a build gives up
) (
    input  logic clk,
    input  logic rst,

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

    output logic           start,   // a pulse
    output logic           cancel,  // a pulse
    output logic           flush,   // a pulse: marks from the cache to memory, after a build
    output ft_pkg::order_t order,

    input logic            finished,  // a pulse: the build has ended, well or not
    input ft_pkg::state_t  state
);
  // Words of the map.
  localparam logic [9:0] Id = 10'h000;
  localparam logic [9:0] Version = 10'h001;
  localparam logic [9:0] Capabilities = 10'h002;
  localparam logic [9:0] Control = 10'h004;
  localparam logic [9:0] Status = 10'h005;
  localparam logic [9:0] InterruptEnable = 10'h006;
  localparam logic [9:0] InterruptStatus = 10'h007;
  localparam logic [9:0] FirstOrder = 10'h008;
  localparam logic [9:0] FirstResult = 10'h020;

  logic [32*ft_pkg::OrderWords-1:0] words;
  logic [32*ft_pkg::ResultWords-1:0] results;
  logic write_now, done_seen, irq_enable;
  logic [9:0] write_word, read_word;
  logic [31:0] write_mask, selected;

  assign order   = words;
  assign results = state.results;

  // Writes: address and data are taken together.
  assign write_now     = s_axi_awvalid && s_axi_wvalid && !s_axi_bvalid;
  assign s_axi_awready = write_now;
  assign s_axi_wready  = write_now;
  assign s_axi_bresp   = 2'b00;
  assign write_word    = s_axi_awaddr[11:2];
  assign write_mask    = {{8{s_axi_wstrb[3]}}, {8{s_axi_wstrb[2]}}, {8{s_axi_wstrb[1]}}, {8{s_axi_wstrb[0]}}};
  assign irq           = irq_enable && done_seen;

  always_ff @(posedge clk) begin
    start  <= 1'b0;
    cancel <= 1'b0;
    flush  <= 1'b0;
    if (rst) begin
      s_axi_bvalid <= 1'b0;
      irq_enable   <= 1'b0;
      done_seen    <= 1'b0;
      words        <= '0;
      words[32*ft_pkg::OrderRounds+:32]    <= 32'd8;
      words[32*ft_pkg::OrderWatchdog+:32]  <= WATCHDOG;
    end else begin
      if (s_axi_bready) s_axi_bvalid <= 1'b0;
      if (write_now) begin
        s_axi_bvalid <= 1'b1;
        if (write_word == Control && s_axi_wstrb[0]) begin
          start  <= s_axi_wdata[0] && !state.busy;
          cancel <= s_axi_wdata[1];
          flush  <= s_axi_wdata[2] && !state.busy;
        end
        if (write_word == InterruptEnable && s_axi_wstrb[0]) irq_enable <= s_axi_wdata[0];
        if (write_word == InterruptStatus && s_axi_wstrb[0] && s_axi_wdata[0]) done_seen <= 1'b0;
        for (int w = 0; w < ft_pkg::OrderWords; w = w + 1) begin
          if (!state.busy && write_word == FirstOrder + 10'(w)) begin
            words[32*w+:32] <= (words[32*w+:32] & ~write_mask) | (s_axi_wdata & write_mask);
          end
        end
      end
      // An end in the cycle of a clear counts: it may be the next build's.
      if (finished) done_seen <= 1'b1;
    end
  end

  // Reads.
  assign s_axi_arready = !s_axi_rvalid;
  assign s_axi_rresp   = 2'b00;
  assign read_word     = s_axi_araddr[11:2];

  always_comb begin
    selected = 32'd0;
    case (read_word)
      Id: selected = ft_pkg::Id;
      Version: selected = ft_pkg::Version;
      Capabilities: selected = CAPABILITIES;
      Status: selected = {16'd0, state.error, state.stage, 1'b0, state.failed, state.done, state.busy};
      InterruptEnable: selected = {31'd0, irq_enable};
      InterruptStatus: selected = {31'd0, done_seen};
      default: begin
        for (int w = 0; w < ft_pkg::OrderWords; w = w + 1) begin
          if (read_word == FirstOrder + 10'(w)) selected = words[32*w+:32];
        end
        for (int w = 0; w < ft_pkg::ResultWords; w = w + 1) begin
          if (read_word == FirstResult + 10'(w)) selected = results[32*w+:32];
        end
      end
    endcase
  end

  always_ff @(posedge clk) begin
    if (rst) begin
      s_axi_rvalid <= 1'b0;
    end else if (s_axi_arvalid && s_axi_arready) begin
      s_axi_rvalid <= 1'b1;
    end else if (s_axi_rready) begin
      s_axi_rvalid <= 1'b0;
    end
    if (s_axi_arvalid && s_axi_arready) s_axi_rdata <= selected;
  end

  // A register is a whole word.
  logic unused;
  assign unused = &{1'b0, s_axi_awaddr[1:0], s_axi_araddr[1:0]};
endmodule
