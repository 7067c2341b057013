// SPDX-License-Identifier: Apache-2.0
// Levels FROM to TO - 1 of Blelloch's scan of a section, without a register: what lies between two
// registers of ft_prefix_sum; by default the whole scan. The first log2(SECTION) levels are the
// up-sweep, a tree of partial sums, each at its right-most leaf; the others hand the sums down.
module ft_prefix_sum_sweep #(
    parameter int WIDTH = 32,
    parameter int SECTION = 32,
    parameter int VALUE_BITS = WIDTH,  // of the values to be summed; their bits above are zero
    parameter int FROM = 0,
    parameter int TO = 2 * $clog2(SECTION)
) (
    input  logic [WIDTH*SECTION-1:0] in_values,
    input  logic [WIDTH-1:0]         in_total,  // of a sweep that begins behind the up-sweep
    output logic [WIDTH*SECTION-1:0] out_values,
    output logic [WIDTH-1:0]         out_total
);
  localparam int Depth = $clog2(SECTION);

  for (genvar level = FROM; level < TO; level++) begin : gen_level
    localparam int Stride = level < Depth ? 1 << level : SECTION >> (level - Depth + 1);
    // Zeros that are known make narrow adders and registers of narrow values.
    localparam logic [WIDTH-1:0] Mask =
        ~({WIDTH{1'b1}} << (VALUE_BITS + (level < Depth ? level + 1 : Depth)));
    logic [WIDTH*SECTION-1:0] in, out;
    logic [WIDTH-1:0] total;

    if (level == FROM) begin : gen_first
      assign in = in_values;
    end else begin : gen_next
      assign in = gen_level[level-1].out;
    end
    if (level == Depth - 1) begin : gen_root
      assign total = out[WIDTH*(SECTION-1)+:WIDTH];
    end else if (level == FROM) begin : gen_given
      assign total = in_total;
    end else begin : gen_handed
      assign total = gen_level[level-1].total;
    end

    for (genvar i = 0; i < SECTION; i++) begin : gen_value
      if ((i + 1) % (2 * Stride) == 0 && (level < Depth || i >= 2 * Stride)) begin : gen_sum
        assign out[WIDTH*i+:WIDTH] = Mask & (in[WIDTH*i+:WIDTH] + in[WIDTH*(i-Stride)+:WIDTH]);
      end else if (level < Depth || (i + 1) % Stride != 0) begin : gen_same
        assign out[WIDTH*i+:WIDTH] = in[WIDTH*i+:WIDTH];
      end else if (i >= 2 * Stride) begin : gen_left
        // What comes before a node comes before its left child.
        assign out[WIDTH*i+:WIDTH] = in[WIDTH*(i+Stride)+:WIDTH];
      end else if (i == Stride - 1) begin : gen_zero
        // Along the left edge of the tree nothing comes before a node.
        assign out[WIDTH*i+:WIDTH] = '0;
      end else begin : gen_right
        assign out[WIDTH*i+:WIDTH] = in[WIDTH*(i-Stride)+:WIDTH];
      end
    end
  end

  assign out_values = gen_level[TO-1].out;
  assign out_total  = gen_level[TO-1].total;
endmodule
