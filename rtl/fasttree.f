// Every module, packages first; paths from this folder.
ft_pkg.sv
common/ft_fifo.sv
common/ft_skid.sv
common/ft_arbiter.sv
common/ft_block_writer.sv
system/ft_registers.sv
system/ft_control.sv
units/ft_lru.sv
units/ft_mark_cache.sv
units/ft_bit_encoding.sv
units/ft_path_compression.sv
