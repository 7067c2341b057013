// Every module, packages first; paths from this folder.
ft_pkg.sv
common/ft_fifo.sv
common/ft_skid.sv
common/ft_arbiter.sv
common/ft_block_writer.sv
common/ft_fifo_two.sv
common/ft_normalise.sv
common/ft_float_sub.sv
common/ft_float_mul.sv
units/ft_quantiser.sv
units/ft_morton_code.sv
units/ft_pair_writer.sv
