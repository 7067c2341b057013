// SPDX-License-Identifier: Apache-2.0
// Types and constants that more than one module knows.
package ft_pkg;

  localparam int MaxDepth = 30;     // levels of the grid, bits of a Morton code
  localparam int MaxAxisBits = 15;  // bits of a cell coordinate on one axis

  // What follows from the scene's bounds and the depth: the registers of the grid. Axis a is in bits
  // [32 * a +: 32] of a vector of three words, and so on for narrower fields.
  typedef struct packed {
    logic [95:0]  lo;      // binary32: lower bound of each axis
    logic [95:0]  scale;   // binary32: 2^15 / extent; zero for a dead axis
    logic [95:0]  extent;  // binary32: upper less lower bound
    logic [11:0]  bits;    // 4 an axis: bits of its coordinate at this depth, 0 to 15
    logic [89:0]  mask;    // 30 an axis: the bits of a code that belong to it
    logic [119:0] rank;    // 4 a bit of a code: which bit of its axis' coordinate it is
    logic [4:0]   depth;   // bits of a code: the depth asked for, or fewer where axes are dead
  } grid_t;

  // What a unit does in a cycle: its `activity`. Stalled on reason r of its own list is 2 + r.
  localparam logic [3:0] Idle = 4'd0;
  localparam logic [3:0] Busy = 4'd1;
  localparam logic [3:0] Stalled = 4'd2;

  // Cycles from operands to result: ft_float_sub, ft_float_mul with WIDE, both one after the other.
  localparam int FloatSubLatency = 3;
  localparam int FloatMulLatency = 3;
  localparam int QuantiserLatency = FloatSubLatency + FloatMulLatency;

  // A child in the device image: a leaf by its place in the leaf table.
  localparam logic [31:0] DeviceLeaf = 32'h8000_0000;

endpackage
