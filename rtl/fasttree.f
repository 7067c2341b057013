// Every module, packages first; paths from this folder.
ft_pkg.sv
common/ft_fifo.sv
common/ft_skid.sv
common/ft_arbiter.sv
common/ft_block_writer.sv
units/ft_scene_reader.sv
units/ft_scene_bound.sv
units/ft_grid_setup.sv
