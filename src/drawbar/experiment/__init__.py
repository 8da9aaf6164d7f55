"""Many runs at once: experiments over cases and seeds on a Dask cluster, resumable, with tables and figures."""
