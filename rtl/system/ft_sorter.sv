// SPDX-License-Identifier: Apache-2.0
// Step 3: the radix sort unit with its prefix sum units.
module ft_sorter #(
    parameter int BUS_BYTES = 16,
    parameter int UNITS = 4,       // prefix sum units, a power of two
    parameter int SECTION = 32,    // pairs a unit
    parameter int STAGES = 2,      // of a prefix sum unit
    parameter int RADIX_BITS = 4,
    parameter int COMBINE = 32,    // bytes of a digit's block
    // Units that sum values of 32 bits. The digits' counts go to the first unit; the others see
    // flags only, and are small where they are built for nothing else.
    parameter int WIDE_UNITS = 1
) (
    input  logic                        clk,
    input  logic                        rst,
    input  logic                        start,
    input  logic [3:0]                  round,
    input  logic                        last,
    input  logic [31:0]                 pairs,
    input  logic [31:0]                 to,
    input  logic [31:0]                 to_ids,
    input  logic                        use_counts_in,
    input  logic [(32<<RADIX_BITS)-1:0] counts_in,
    input  logic                        rd_valid,
    output logic                        rd_ready,
    input  logic [8*BUS_BYTES-1:0]      rd_data,
    output logic                        wr_valid,
    input  logic                        wr_ready,
    output logic [31:0]                 wr_addr,
    output logic [6:0]                  wr_bytes,
    output logic [8*COMBINE-1:0]        wr_data,
    output logic                        done,
    output logic [3:0]                  activity,
    output logic [4*UNITS-1:0]          psu_activity
);
  logic [UNITS-1:0] psu_in_valid, psu_in_ready, psu_out_valid, psu_out_ready;
  logic [UNITS*SECTION*32-1:0] psu_in_values, psu_out_sums;
  logic [32*UNITS-1:0] psu_out_total;

  ft_radix_sort #(
      .BUS_BYTES(BUS_BYTES), .UNITS(UNITS), .SECTION(SECTION), .RADIX_BITS(RADIX_BITS),
      .COMBINE(COMBINE)
  ) u_control (
      .clk(clk), .rst(rst), .start(start), .round(round), .last(last), .pairs(pairs), .to(to),
      .to_ids(to_ids), .use_counts_in(use_counts_in), .counts_in(counts_in),
      .rd_valid(rd_valid), .rd_ready(rd_ready), .rd_data(rd_data),
      .wr_valid(wr_valid), .wr_ready(wr_ready), .wr_addr(wr_addr), .wr_bytes(wr_bytes),
      .wr_data(wr_data),
      .psu_in_valid(psu_in_valid), .psu_in_ready(psu_in_ready), .psu_in_values(psu_in_values),
      .psu_out_valid(psu_out_valid), .psu_out_ready(psu_out_ready), .psu_out_sums(psu_out_sums),
      .psu_out_total(psu_out_total),
      .done(done), .activity(activity)
  );

  for (genvar u = 0; u < UNITS; u++) begin : gen_psu
    ft_prefix_sum #(
        .WIDTH(32), .SECTION(SECTION), .STAGES(STAGES), .VALUE_BITS(u < WIDE_UNITS ? 32 : 1)
    ) u_psu (
        .clk(clk), .rst(rst),
        .in_valid(psu_in_valid[u]), .in_ready(psu_in_ready[u]),
        .in_values(psu_in_values[32*SECTION*u+:32*SECTION]),
        .out_valid(psu_out_valid[u]), .out_ready(psu_out_ready[u]),
        .out_sums(psu_out_sums[32*SECTION*u+:32*SECTION]),
        .out_total(psu_out_total[32*u+:32]), .activity(psu_activity[4*u+:4])
    );
  end
endmodule
