-- 75 connections that each send the next request 195 ms after a response: 300 requests a second with responses in 55 ms.
function delay()
  return 195
end
