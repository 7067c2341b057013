// Every module, packages first; paths from this folder.
ft_pkg.sv
common/ft_fifo.sv
common/ft_skid.sv
common/ft_arbiter.sv
common/ft_block_writer.sv
system/ft_window.sv
system/ft_write_port.sv
system/ft_write_order.sv
system/ft_stream_reader.sv
system/ft_block_reader.sv
system/ft_axi_rules.sv
system/ft_bus_writes.sv
system/ft_bus.sv
