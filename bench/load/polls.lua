-- 75 connections that each ask again 195 ms after they were answered: 300 requests a second at 55 ms an answer.
function delay()
  return 195
end
