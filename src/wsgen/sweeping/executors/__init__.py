"""Where runs are computed: on this machine or on others, behind `concurrent.futures.Executor`."""
