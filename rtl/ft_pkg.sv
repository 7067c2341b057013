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

  // What the host orders: registers from 0x020 on, the last member in the first word.
  typedef struct packed {
    logic [31:0] watchdog;            // 18: cycles without progress before a build gives up; 0: never
    logic [31:0] window_end;          // 17: first byte behind it; 0: the end of the addresses
    logic [31:0] window_begin;        // 16: what lies outside the window is left alone
    logic [31:0] rounds;              // 15: of the sort, four bits of the code each
    logic [31:0] mark_bytes;          // 14: at least max(64, 2^(depth+1) / 8)
    logic [31:0] leaf_capacity;       // 13: leaves that leaf_codes, leaf_rows and nodes have room for
    logic [31:0] reference_capacity;  // 12: references that pairs and sorted arrays have room for
    logic [31:0] nodes;               // 11: addresses, multiples of 4096
    logic [31:0] marks;               // 10
    logic [31:0] leaf_rows;           // 9
    logic [31:0] leaf_codes;          // 8
    logic [31:0] sorted_ids;          // 7
    logic [31:0] sorted_codes;        // 6
    logic [31:0] pairs1;              // 5
    logic [31:0] pairs0;              // 4
    logic [31:0] scene;               // 3
    logic [31:0] scene_bytes;         // 2: size of the scene's buffer
    logic [31:0] shape;               // 1: [4:0] depth, [8] longest axis first, else cyclic
    logic [31:0] triangles;           // 0
  } order_t;
  localparam int OrderWords = 19;
  localparam int OrderRounds = 15;
  localparam int OrderWatchdog = 18;

  // What the host reads: registers from 0x080 on, the last member in the first word.
  typedef struct packed {
    logic [31:0] mark_write_backs;    // 26
    logic [31:0] mark_write_hits;     // 25
    logic [31:0] mark_writes;         // 24
    logic [31:0] mark_read_hits;      // 23
    logic [31:0] mark_reads;          // 22
    logic [31:0] climb_steps;         // 21
    logic [31:0] write_beats;         // 20
    logic [31:0] read_beats;          // 19
    logic [191:0] stage_cycles;       // 13: scene_bound, morton_code, ... path_compression
    logic [63:0] cycles;              // 11: of the build so far
    logic [31:0] error_detail;        // 10: by error
    logic [95:0] upper;               // 7: the scene's bounds
    logic [95:0] lower;               // 4
    logic [31:0] grid;                // 3: [4:0] depth, [11:8] [15:12] [19:16] bits of x, y, z
    logic [31:0] root;                // 2: a child, as in the device image
    logic [31:0] leaves;              // 1: rows of the leaf table (an empty scene: 0, with one row)
    logic [31:0] references;          // 0
  } results_t;
  localparam int ResultWords = 27;

  // The stage at work, as in the status register.
  localparam logic [3:0] StageNone = 4'd0;
  localparam logic [3:0] StageSceneBound = 4'd1;
  localparam logic [3:0] StageMortonCode = 4'd2;
  localparam logic [3:0] StageRadixSort = 4'd3;
  localparam logic [3:0] StageLeafNode = 4'd4;
  localparam logic [3:0] StageInternalNode = 4'd5;
  localparam logic [3:0] StagePathCompression = 4'd6;

  // Why a build has failed.
  localparam logic [7:0] ErrorNone = 8'd0;
  localparam logic [7:0] ErrorOrder = 8'd1;       // detail: the order's word that cannot be
  localparam logic [7:0] ErrorScene = 8'd2;       // larger than its buffer; detail: its buffer's size
  localparam logic [7:0] ErrorNotFinite = 8'd3;   // detail: coordinate, nine a triangle
  localparam logic [7:0] ErrorReferences = 8'd4;  // more than there is room for; detail: that room
  localparam logic [7:0] ErrorLeaves = 8'd5;      // more than there is room for; detail: that room
  localparam logic [7:0] ErrorMemory = 8'd6;      // a response other than OKAY; detail: [4] write, [3:0] its ID
  localparam logic [7:0] ErrorWindow = 8'd7;      // a request outside the window; detail: its address
  localparam logic [7:0] ErrorCancelled = 8'd8;
  localparam logic [7:0] ErrorTimeout = 8'd9;     // nothing has moved for the watchdog's cycles

  typedef struct packed {
    results_t   results;
    logic [7:0] error;
    logic [3:0] stage;
    logic       failed;
    logic       done;
    logic       busy;
  } state_t;

  localparam logic [31:0] Id = 32'h4654_5245;  // "FTRE"
  localparam logic [31:0] Version = 32'h0000_0001;
  // Cycles from operands to result: ft_float_sub, ft_float_mul, both one after the other.
  localparam int FloatSubLatency = 3;
  localparam int FloatMulLatency = 3;
  localparam int QuantiserLatency = FloatSubLatency + FloatMulLatency;

  // A child in the device image: a leaf by its place in the leaf table.
  localparam logic [31:0] DeviceLeaf = 32'h8000_0000;

endpackage
