"""Names of packages, after REP-144."""
