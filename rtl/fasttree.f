// Every module, packages first; paths from this folder.
ft_pkg.sv
common/ft_fifo.sv
common/ft_skid.sv
common/ft_arbiter.sv
common/ft_block_writer.sv
units/ft_plane.sv
units/ft_split_plane.sv
units/ft_internal_node.sv
units/ft_leaf_node.sv
