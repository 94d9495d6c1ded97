"""The server of the live designer: its page, its messages, and what keeps strangers out."""
